# cmake -DSOURCE=FOLDER -DFILE=FILE -P commit.cmake: a source file that says of which commit a
# source folder is. It is written only when it would change.

execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
else()
  execute_process(COMMAND git -C ${SOURCE} status --porcelain --untracked-files=no
    OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    string(APPEND commit "+changes")
  endif()
endif()
file(CONFIGURE OUTPUT ${FILE} CONTENT "#include \"baker/job/version.h\"

namespace paperbake {
const char* const program_commit = \"${commit}\";
}
")
