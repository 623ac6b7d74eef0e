#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace paperbake {

/// A file that appears under its name complete or not at all. Everything is written to NAME.part
/// beside it, which commit() renames after all bytes have reached the disk; without commit() the
/// destructor deletes it. What lies at NAME.part before, a link too, is removed and not followed;
/// a link at NAME is replaced. All functions throw Error(ErrorCode::folder) with the file and the
/// reason that the system gives.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { write(text.data(), text.size()); }
  // position: before the end of what has been written
  void write_at(std::uint64_t position, const void* bytes, std::size_t count);

  /// Drops everything from this position on; the next write starts there. May be called after a
  /// write that failed. The disk space is released only by commit(), so that something smaller can
  /// still be written when the disk is full.
  void truncate(std::uint64_t position);
  void flush();  // throws now if the disk has no room for what has been written

  /// The path of NAME.part, for libraries that open a file by its name; they must close it before
  /// commit().
  const std::filesystem::path& part() const { return part_; }

  enum class Sync { yes, no };  // yes: all bytes reach the disk before the file gets its name
  void commit(Sync = Sync::yes);

 private:
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_, part_;
  std::FILE* file_;
  std::uint64_t end_ = 0;  // [bytes] end of what this object has written
};

/// Deletes the NAME.part of every file that was begun and not committed. For a program that ends at
/// once: what is written afterwards is lost.
void delete_unfinished_files();

/// The bytes of a file; nothing when it cannot be read, or is no file: a folder, a FIFO, a device,
/// a socket. Never waits for somebody to write it.
std::optional<std::string> read_file(const std::filesystem::path&);

/// What a path is that could be waited for or read for ever, for a sentence: "a FIFO", "a device",
/// "a socket", "a folder"; empty: a file, or nothing.
std::string kind_of_no_file(const std::filesystem::path&);

/// Writes a text as an AtomicFile.
void write_atomically(const std::filesystem::path&, std::string_view text);

/// The same without waiting for the disk: after a crash of the system, not of the program, the file
/// may be damaged.
void write_quickly(const std::filesystem::path&, std::string_view text);

}  // namespace paperbake
