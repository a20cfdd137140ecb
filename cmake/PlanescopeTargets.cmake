# What every target of the project shares: language level, warnings, sanitizers.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# The houses go into programs and into the shared libraries of library/, which show only what is marked.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
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
      -fsanitize=${PLANESCOPE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
      # False alarms: the compiler does not see through what they add.
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
    target_link_options(${target} PRIVATE -fsanitize=${PLANESCOPE_SANITIZE})
  else()
    # Files come from anybody: what slips past the checks shall end the program, not take it over.
    target_compile_options(${target} PRIVATE -fstack-protector-strong)
    target_compile_definitions(${target} PRIVATE
      $<$<CONFIG:Release>:_FORTIFY_SOURCE=2> $<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS>)
    target_link_options(${target} PRIVATE -Wl,-z,relro,-z,now)
  endif()
endfunction()

# planescope_unity(target): with PLANESCOPE_UNITY, compiles the target's files sixteen at a time, in the
# order they are listed and only with files of their own folder: half the time. Names in anonymous
# namespaces must then differ within a folder; files with compile options of their own compile alone.
function(planescope_unity target)
  if(NOT PLANESCOPE_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A class made of private classes counts as shared where its file is included.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source ${sources})
    get_filename_component(source ${source} ABSOLUTE)
    get_filename_component(folder ${source} DIRECTORY)
    # The same in every checkout, for ccache.
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    string(MAKE_C_IDENTIFIER "of_${folder}" folder)
    math(EXPR batch "${count_${folder}}0 / 160")
    math(EXPR count_${folder} "${count_${folder}}+0 + 1")
    set_source_files_properties(${source} TARGET_DIRECTORY ${target}
      PROPERTIES UNITY_GROUP "${folder}_${batch}")
  endforeach()
endfunction()

# planescope_house(NAME [KNOWS houses...] [FOLDERS folders...] [WITHOUT sources...]): the library
# planescope::NAME of all .cpp files below the current folder, or below some folders of it, on top of the
# houses it knows.
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

# planescope_test(NAME sources... [LIBS libs...] [LABELS labels...]): one GoogleTest executable, its tests
# known to CTest one by one.
function(planescope_test name)
  cmake_parse_arguments(ARG "" "" "LIBS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  planescope_target_defaults(${name})
  target_link_libraries(${name} PRIVATE planescope::synthetic ${ARG_LIBS} GTest::gtest GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE PLANESCOPE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # The libraries are optimised to the end; tests need not be, and compile quicker.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  planescope_unity(${name})
  # Listing the tests is a start of the program: it waits for the test run, off the build's path.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${ARG_LABELS}")
endfunction()
