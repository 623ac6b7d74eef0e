#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace paperbake {

/// A file that appears whole or not at all. It is written beside its place as NAME.part and takes
/// its name in commit(), after everything has reached the disk; without commit() it vanishes with
/// the object. All functions throw Error(Fault::folder) that names the file and the system's
/// reason.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { write(text.data(), text.size()); }
  // position: within what is written
  void write_at(std::uint64_t position, const void* bytes, std::size_t count);

  /// Everything from here on is forgotten, and written over next; also after a write that failed.
  /// The room that it took on the disk stays until commit(), so that a little can still be written
  /// when the disk is full.
  void truncate(std::uint64_t position);
  void flush();  // tells now whether what is written has found room

  /// Where the bytes go until commit(), for libraries that write files by name; they must close it
  /// before commit().
  const std::filesystem::path& part() const { return part_; }

  void commit();

 private:
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_, part_;
  std::FILE* file_;
  std::uint64_t end_ = 0;  // [bytes] written through here
};

/// All bytes of a file; nothing when it cannot be read.
std::optional<std::string> read_file(const std::filesystem::path&);

/// The whole text as one file, whole or not at all.
void write_atomically(const std::filesystem::path&, std::string_view text);

}  // namespace paperbake
