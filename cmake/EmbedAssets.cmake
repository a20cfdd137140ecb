# planescope_embed(TARGET file...): compiles files into TARGET. Each becomes
#   extern "C" const unsigned char planescope_asset_<name>[], planescope_asset_<name>_end[];
# where <name> is the file's name with every character except letters and digits replaced by '_'.
# A zero byte follows the end, so that text can be used as a C string. The assembler includes the
# file directly: there are no generated arrays, and changing an asset rebuilds only its object.
function(planescope_embed target)
  foreach(file ${ARGN})
    get_filename_component(path ${file} ABSOLUTE)
    get_filename_component(base ${file} NAME)
    if(NOT EXISTS ${path})
      message(FATAL_ERROR "planescope_embed: ${path} does not exist")
    endif()
    string(MAKE_C_IDENTIFIER ${base} symbol)
    set(asm ${CMAKE_CURRENT_BINARY_DIR}/embed_${symbol}.S)
    # Written only if changed, so that configuring again rebuilds nothing. The last line declares
    # that the object needs no executable stack.
    file(CONFIGURE OUTPUT ${asm} @ONLY CONTENT
"        .section .rodata
        .global planescope_asset_@symbol@
        .global planescope_asset_@symbol@_end
        .balign 16
planescope_asset_@symbol@:
        .incbin \"@path@\"
planescope_asset_@symbol@_end:
        .byte 0
        .section .note.GNU-stack, \"\", %progbits
")
    set_source_files_properties(${asm} TARGET_DIRECTORY ${target} PROPERTIES OBJECT_DEPENDS ${path})
    target_sources(${target} PRIVATE ${asm})
  endforeach()
endfunction()
