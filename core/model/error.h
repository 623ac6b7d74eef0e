#pragma once

#include <stdexcept>
#include <string>

namespace paperbake {

/// What went wrong, by who has to act. The value is the exit code of the tool.
enum class ErrorCode {
  simulation = 1,  // the solver could not continue
  command = 2,     // the command line, preset or job file is wrong
  scene = 3,       // the scene cannot be used
  // 4 is gate_missed, which is not an error
  stopped = 5,  // somebody stopped the bake: the same command resumes it
  folder = 6,   // the output folder is busy or not writable
};

// exit code of the tool when its work is done, with a result that is not as good as it has to be
inline constexpr int gate_missed = 4;

/// The exception of the project; what is thrown is one, or derived from it, or a Damage. It is
/// written for the artist, and only the tool prints it:
///
///   place      file, node, frame: where
///   cause      one sentence: what is wrong, with numbers
///   remedy     one sentence: what to try; may be empty
///   what()     the three, each on its own line, the last two indented
struct Error : std::runtime_error {
  Error(ErrorCode code, std::string place, std::string cause, std::string remedy = {})
      : std::runtime_error(place + "\n  " + cause + (remedy.empty() ? "" : "\n  " + remedy)),
        code(code),
        place(std::move(place)),
        cause(std::move(cause)),
        remedy(std::move(remedy)) {}

  ErrorCode code;
  std::string place, cause, remedy;
};

/// What is wrong with the bytes of a file, as half a sentence: "a chunk is longer than the file".
/// Whoever knows the name of the file catches it and makes an Error of it.
struct Damage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace paperbake
