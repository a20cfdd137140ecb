#!/usr/bin/awk -f
# Converts the comments of our headers for Doxygen: a trailing comment, and its continuation lines,
# documents its member; the paragraph at the start of a file documents the file. Removes the inline
# namespace.
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
