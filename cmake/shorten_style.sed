# SPDX-License-Identifier: Apache-2.0
# A style sheet without comments, blanks that say nothing, and ends of lines.
s,/\*[^*]*\*/,,g
s/^[[:space:]]+//
s/ *([{};,>]) */\1/g
s/: /:/g
H
$!d
x
s/\n//g
