# Run at every build: writes OUTPUT with VERSION and the commit that SOURCE_DIR stands at, COMMIT where it is
# no checkout, and touches it only when that changed, so that nothing is compiled again without need.
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --show-prefix HEAD
  OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
set(commit ${COMMIT})
set(modified false)
# An empty prefix: SOURCE_DIR is the checkout itself, not a folder inside some other one.
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
