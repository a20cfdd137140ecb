# Runs at every build: writes VERSION and the commit of SOURCE_DIR to OUTPUT (COMMIT if SOURCE_DIR is not a
# checkout). Leaves an unchanged OUTPUT alone, so that nothing is recompiled.
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --show-prefix HEAD
  OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
set(commit ${COMMIT})
set(modified false)
# An empty prefix means that SOURCE_DIR is the checkout itself, not a folder inside another one.
if(NOT failed AND answer MATCHES "^\n?([0-9a-f]+)$")
  set(commit ${CMAKE_MATCH_1})
  execute_process(COMMAND git -C ${SOURCE_DIR} diff-index --quiet HEAD --
    ERROR_QUIET RESULT_VARIABLE differs)
  if(differs)
    set(modified true)
  endif()
endif()
set(text "#define PLANESCOPE_BUILD_VERSION \"${VERSION}\"
#define PLANESCOPE_BUILD_COMMIT \"${commit}\"
#define PLANESCOPE_BUILD_MODIFIED ${modified}
")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
