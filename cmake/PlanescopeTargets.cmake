# What every target of the project shares: language level, warnings, sanitizers.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

function(planescope_target_defaults target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    # The same bits on every machine: no fused multiply-add unless the code asks for it.
    -ffp-contract=off)
  # libOpen3D drags in a hundred shared libraries; programs that call none of it start without.
  target_link_options(${target} PRIVATE -Wl,--as-needed)
  if(PLANESCOPE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(PLANESCOPE_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${PLANESCOPE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
    target_link_options(${target} PRIVATE -fsanitize=${PLANESCOPE_SANITIZE})
  endif()
endfunction()

# planescope_test(NAME sources... [LIBS libs...] [LABELS labels...]): one GoogleTest executable,
# its tests known to CTest one by one.
function(planescope_test name)
  cmake_parse_arguments(ARG "" "" "LIBS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  planescope_target_defaults(${name})
  target_link_libraries(${name} PRIVATE planescope::core ${ARG_LIBS} GTest::gtest GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE PLANESCOPE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # Listing the tests is a start of the program: it waits for the test run, off the build's path.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${ARG_LABELS}")
endfunction()
