# Used by check_docs: extracts items from Markdown files, one per line, as "FILE:LINE <tab> KIND <tab> TEXT".
#   code  a command in a code block, or inline code; without quotes and brackets
#   link  target of a link
#   bare  a figure (picture, or table of numbers) without a command in its section or at the start of
#         its chapter, in documents with figures

function newlines(s) { return gsub(/\n/, "", s) }

function code(line, s,   commands, n, i) {
  if (s ~ /planescope(-lab)? [a-z]|scripts\/[a-z]|ctest /) command = 1
  sub(/^[$>] /, "", s)  # prompt
  sub(/ #.*/, "", s)  # a comment
  sub(/  .*/, "", s)  # description beside a command
  gsub(/[]["']/, "", s)
  n = split(s, commands, / && |; | \| /)
  for (i = 1; i <= n; ++i) print file ":" line "\tcode\t" commands[i]
}

# Extracts inline code and links from the lines collected in `text`, because both may wrap.
function paragraph(   s, found) {
  s = text
  text = ""
  while (match(s, /`[^`]+`|\]\([^) ]+\)/)) {
    found = substr(s, RSTART, RLENGTH)
    start += newlines(substr(s, 1, RSTART))
    s = substr(s, RSTART + RLENGTH)
    if (found ~ /^`/) code(start, inline(found))
    else print file ":" start "\tlink\t" substr(found, 3, length(found) - 3)
    start += newlines(found)
  }
}
function inline(s) {
  gsub(/ *\n */, " ", s)
  return substr(s, 2, length(s) - 2)
}

function figure() {
  if (file ~ /docs\/(classifier|labels|method|reproduction)\.md$/) at[++figures] = FNR
}
function end_of_section(   i) {
  paragraph()
  for (i = 1; i <= figures && !command && !opening; ++i) print file ":" at[i] "\tbare\t"
  figures = 0
}

function is_number(cell) { return cell ~ /[0-9]/ && cell !~ /[^0-9 .,;\/%+-]/ }
function has_numbers(row,   cells, n, i) {
  n = split(row, cells, "|")
  for (i = 1; i <= n; ++i) if (is_number(cells[i])) return 1
  return 0
}

FNR == 1 {
  end_of_section()
  file = FILENAME
  command = opening = fenced = rows = level = 0
  blank = 1
}
/^ *```/ { paragraph(); fenced = !fenced; next }
fenced || (/^    / && (blank || indented)) {
  indented = !fenced
  sub(/^ */, "")
  if (joined == "") first = FNR
  joined = joined $0
  if (sub(/ *\\$/, " ", joined)) next
  code(first, joined)
  joined = ""
  next
}
/^#/ {
  end_of_section()
  if (/^###/) opening = opening || (level < 3 && command)
  else opening = 0
  level = /^###/ ? 3 : 2
  command = 0
}
/^!\[/ { figure() }
/^\|/ { paragraph(); if (has_numbers($0) && ++rows == 2) figure() }
!/^\|/ { rows = 0 }
/^ *$/ { paragraph() }
{
  blank = /^ *$/
  indented = 0
  if (text == "") start = FNR
  gsub(/\\\|/, "|")
  text = text $0 "\n"
}
END { end_of_section() }
