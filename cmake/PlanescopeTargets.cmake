# Settings shared by all targets: language standard, warnings, sanitizers.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# Houses are linked into programs and into the shared libraries of library/, which export only marked symbols.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

function(planescope_target_defaults target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    # No fused multiply-add unless the code uses it explicitly, for identical results on every machine.
    -ffp-contract=off)
  # libOpen3D depends on a hundred shared libraries; programs that do not call it start without them.
  target_link_options(${target} PRIVATE -Wl,--as-needed)
  if(PLANESCOPE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(PLANESCOPE_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${PLANESCOPE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
      # The sanitizers' instrumentation causes false alarms.
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
    target_link_options(${target} PRIVATE -fsanitize=${PLANESCOPE_SANITIZE})
  else()
    # Input files are untrusted: a bug in a reader must end the program, not allow code execution.
    target_compile_options(${target} PRIVATE -fstack-protector-strong)
    target_compile_definitions(${target} PRIVATE
      $<$<CONFIG:Release>:_FORTIFY_SOURCE=2> $<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS>)
    target_link_options(${target} PRIVATE -Wl,-z,relro,-z,now)
  endif()
endfunction()

# planescope_unity(target): with PLANESCOPE_UNITY, compiles the target's files in batches of sixteen from
# the same folder, in the listed order, which halves the build time. Names in anonymous namespaces must
# then differ within a folder; files with their own compile options are compiled separately.
function(planescope_unity target)
  if(NOT PLANESCOPE_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # In a unity build, GCC warns about classes with members from anonymous namespaces.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source ${sources})
    get_filename_component(source ${source} ABSOLUTE)
    get_filename_component(folder ${source} DIRECTORY)
    # The same name in every checkout, for ccache.
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    string(MAKE_C_IDENTIFIER "of_${folder}" folder)
    math(EXPR batch "${count_${folder}}0 / 160")
    math(EXPR count_${folder} "${count_${folder}}+0 + 1")
    set_source_files_properties(${source} TARGET_DIRECTORY ${target}
      PROPERTIES UNITY_GROUP "${folder}_${batch}")
  endforeach()
endfunction()

# planescope_house(NAME [KNOWS houses...] [FOLDERS folders...] [WITHOUT sources...]): library
# planescope::NAME with all .cpp files below the current folder, or below FOLDERS in it. Links the houses
# after KNOWS.
function(planescope_house name)
  cmake_parse_arguments(ARG "" "" "KNOWS;FOLDERS;WITHOUT" ${ARGN})
  set(patterns *.cpp)
  if(ARG_FOLDERS)
    list(TRANSFORM ARG_FOLDERS APPEND /*.cpp OUTPUT_VARIABLE patterns)
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${patterns})
  list(REMOVE_ITEM sources ${ARG_WITHOUT})
  add_library(planescope_${name} STATIC ${sources})
  add_library(planescope::${name} ALIAS planescope_${name})
  planescope_target_defaults(planescope_${name})
  target_include_directories(planescope_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  list(TRANSFORM ARG_KNOWS PREPEND planescope::)
  target_link_libraries(planescope_${name} PUBLIC ${ARG_KNOWS})
  planescope_unity(planescope_${name})
endfunction()

# planescope_test(NAME sources... [LIBS libs...] [LABELS labels...]): a GoogleTest executable whose tests are
# registered with CTest individually.
function(planescope_test name)
  cmake_parse_arguments(ARG "" "" "LIBS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  planescope_target_defaults(${name})
  target_link_libraries(${name} PRIVATE planescope::synthetic ${ARG_LIBS} GTest::gtest GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE PLANESCOPE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # Tests compile faster without full optimization; the libraries keep theirs.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  planescope_unity(${name})
  # Listing the tests starts the program, so it is deferred from the build to the test run.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${ARG_LABELS}")
endfunction()
