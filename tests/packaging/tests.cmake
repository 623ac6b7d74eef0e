# The packages where nothing of ours is installed: a minute or two. docs/packages.md says what each
# test needs.

enable_testing()
set(PACKAGING ${PROJECT_SOURCE_DIR}/tests/packaging)
set(SCRATCH ${CMAKE_BINARY_DIR}/packages_test)

function(packages_test name)  # name COMMAND...: judges packages that packages.made has made
  add_test(NAME packages.${name} COMMAND ${ARGN} WORKING_DIRECTORY ${PACKAGING})
  set_tests_properties(packages.${name} PROPERTIES LABELS packages TIMEOUT 900
    SKIP_RETURN_CODE 77 FIXTURES_REQUIRED packages)
endfunction()

add_test(NAME packages.made COMMAND ${CMAKE_COMMAND} --build ${CMAKE_BINARY_DIR}
  --target package_deb blender_addon wheel)
set_tests_properties(packages.made PROPERTIES LABELS packages TIMEOUT 300 FIXTURES_SETUP packages)

set(PACKAGES ${PROJECT_SOURCE_DIR} ${CMAKE_BINARY_DIR} ${PACKAGE_VERSION})
packages_test(contents python3 -B contents_test.py ${PACKAGES} ${SCRATCH}/contents)
packages_test(deb python3 -B deb_test.py ${PACKAGES} ${SCRATCH}/deb)
packages_test(wheel /usr/bin/python3 -B wheel_test.py ${PACKAGES} ${SCRATCH}/wheel)
packages_test(blender_zip ${PROJECT_SOURCE_DIR}/.venv/bin/python -B blender_zip_test.py
  ${PACKAGES} ${SCRATCH}/blender_zip)
