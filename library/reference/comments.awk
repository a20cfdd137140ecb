#!/usr/bin/awk -f
# The comments of our headers as Doxygen takes them: what stands behind a member, and goes on in the lines
# below, is of that member; a paragraph that begins a file is of the file. The inline namespace is left out.
FNR == 1 { trailing = 0; opening = 1 }
/namespace v0 *{|} *\/\/ namespace v0/ { print ""; next }
{
  line = $0
  if (opening && line ~ /^\/\/ /) {
    if (opening == 1) print "/// @file"
    opening = 2
    sub(/^\/\//, "///", line)
  } else if (line !~ /^(#pragma once|\/\/)?$/ && line !~ /^\/\//) {
    opening = 0
  }
  if (match(line, /[;,{}] +\/\/ /) && line !~ /^ *\/\//) {
    at = RSTART + 1
    rest = substr(line, at)
    sub(/ +\/\/ /, "  ///< ", rest)
    line = substr(line, 1, at - 1) rest
    trailing = 1
  } else if (trailing && line ~ /^ {8,}\/\/ /) {
    sub(/\/\/ /, "///< ", line)
  } else {
    trailing = 0
  }
  print line
}
