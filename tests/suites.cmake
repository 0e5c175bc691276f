# Included by ctest: every suite of a program of tests becomes a test of ctest's. tests/CMakeLists.txt sets `name`,
# `program`, `filter` (of GoogleTest) and `properties`.
if(NOT EXISTS "${program}")
  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)
  return()
endif()
# Tests as the program lists them, asked for once for each build of it.
set(listed "${program}.tests")
if("${program}" IS_NEWER_THAN "${listed}")
  execute_process(COMMAND "${program}" --gtest_list_tests "--gtest_filter=${filter}" OUTPUT_VARIABLE tests TIMEOUT 60
                  RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${program} does not list its tests: ${status}")
  endif()
  file(WRITE "${listed}" "${tests}")
endif()
file(STRINGS "${listed}" suites REGEX "^[^ ]+\\.( *#.*)?$")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "\\.( *#.*)?$" "" suite "${suite}")
  add_test("${suite}" "${program}" "--gtest_filter=${suite}.*")
  set_tests_properties("${suite}" PROPERTIES ${properties})
endforeach()
