# Elementary functions are those of core/model/elementary_functions, which are the same on every
# processor: all that a library calls of the C library's mathematics gets their names.

set(PAPERBAKE_ELEMENTARY_FUNCTIONS sin cos sincos tan asin acos atan atan2 exp log pow)
set(PAPERBAKE_RENAMED ${PROJECT_BINARY_DIR}/elementary_functions.txt)
list(TRANSFORM PAPERBAKE_ELEMENTARY_FUNCTIONS REPLACE "(.+)" "\\1 paperbake_\\1\n"
  OUTPUT_VARIABLE renamed)
string(CONCAT renamed ${renamed})
file(CONFIGURE OUTPUT ${PAPERBAKE_RENAMED} CONTENT "${renamed}")

# paperbake_elementary_functions(TARGET): for a static library
function(paperbake_elementary_functions target)
  add_custom_command(TARGET ${target} POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} --redefine-syms=${PAPERBAKE_RENAMED} $<TARGET_FILE:${target}> VERBATIM)
endfunction()
