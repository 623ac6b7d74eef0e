#pragma once

#include <filesystem>
#include <vector>

namespace paperbake {

/// Takes from this process, for good, what an importer of files does not need, as far as the kernel
/// can do it: all system calls but those that read files, compute and answer (seccomp; x86-64 and
/// 64-bit ARM), so that it cannot write, make, rename or remove files, open a socket, start a
/// process or a program, or reach other processes; and to read files outside some folders
/// (Landlock, Linux 5.13). What it tries then fails with EPERM or EACCES. What it has open stays
/// open.
/// readable  the only folders that may be read, with all below; empty: all of them
void confine_process(const std::vector<std::filesystem::path>& readable);

}  // namespace paperbake
