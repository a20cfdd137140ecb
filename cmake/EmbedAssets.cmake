# planescope_embed(TARGET file...): compiles files into TARGET. Each becomes
#   extern "C" const unsigned char planescope_asset_<name>[], planescope_asset_<name>_end[];
# where <name> is the file's name with every character but letters and digits turned into '_'.
function(planescope_embed target)
  foreach(file ${ARGN})
    get_filename_component(path ${file} ABSOLUTE)
    get_filename_component(base ${file} NAME)
    string(MAKE_C_IDENTIFIER ${base} symbol)
    set(asm ${CMAKE_CURRENT_BINARY_DIR}/embed_${symbol}.S)
    file(CONFIGURE OUTPUT ${asm} CONTENT
"        .section .rodata
        .global planescope_asset_@symbol@
        .global planescope_asset_@symbol@_end
        .balign 16
planescope_asset_@symbol@:
        .incbin \"@path@\"
planescope_asset_@symbol@_end:
        .byte 0
        .section .note.GNU-stack,\"\",@progbits
" @ONLY)
    file(READ ${asm} text)
    string(REPLACE "\"\",progbits" "\"\",@progbits" text "${text}")
    file(WRITE ${asm} "${text}")
    set_source_files_properties(${asm} PROPERTIES OBJECT_DEPENDS ${path})
    target_sources(${target} PRIVATE ${asm})
  endforeach()
endfunction()
