# Writes presets as C++, so that the program needs no files beside it:
#   cmake -P embed_presets.cmake OUT.cpp NAME.toml ...
# The order in OUT.cpp is that of the names, and no path goes into it: the same presets give the
# same bytes.

math(EXPR last "${CMAKE_ARGC} - 1")
set(output "${CMAKE_ARGV3}")
set(files "")
foreach(i RANGE 4 ${last})
  list(APPEND files "${CMAKE_ARGV${i}}")
endforeach()
list(SORT files COMPARE FILE_BASENAME)

set(rows "")
list(LENGTH files count)
foreach(file IN LISTS files)
  get_filename_component(name "${file}" NAME_WE)
  file(READ "${file}" text)
  string(FIND "${text}" ")toml\"" end_of_literal)
  if(NOT end_of_literal EQUAL -1)
    message(FATAL_ERROR "${file}: the text )toml\" cannot be embedded")
  endif()
  string(APPEND rows "    {\"${name}\", R\"toml(${text})toml\"},\n")
endforeach()

file(WRITE "${output}" "// Made by embed_presets.cmake from presets/*.toml.
namespace paperbake {
struct BuiltInPreset { const char* name; const char* text; };
extern const BuiltInPreset built_in_presets[];
extern const int built_in_preset_count;
const BuiltInPreset built_in_presets[] = {
${rows}};
const int built_in_preset_count = ${count};
}  // namespace paperbake
")
