# SPDX-License-Identifier: Apache-2.0
# JavaScript without comments and without the blanks that say nothing. Lines stay where they are, for messages of the browser. What
# stands in quotation marks, in regular expressions and in the text of templates stays as it is. LC_ALL=C makes it the same everywhere.
function is_word(c) { return c ~ /[A-Za-z0-9_$]/ }

# Whether a / here begins a regular expression.
function begins_pattern(before) { return before == "" || before ~ /[(,=:\[!&|?;{>]$/ || before ~ /(^|[^A-Za-z0-9_$])return$/ }

# Where what begins at `from` with the character `mark` ends in this line.
function end_of(from, mark,   at, c, in_class) {
    for (at = from + 1; at <= length(line); ++at) {
        c = substr(line, at, 1)
        if (c == "\\") ++at
        else if (mark == "/" && c == "[") in_class = 1
        else if (mark == "/" && c == "]") in_class = 0
        else if (c == mark && !in_class) return at
    }
    return length(line)
}

function take_template(   c) { # its text, up to its end or to what is put in
    c = substr(line, i, 1)
    if (c == "\\" || substr(line, i, 2) == "${") {
        out = out substr(line, i, 2)
        ++i
        if (c == "$") { levels[++top] = depth; in_text = 0 }
    } else {
        out = out c
        if (c == "`") in_text = 0
    }
}

function take_code(   c, last) {
    c = substr(line, i, 1)
    last = substr(out, length(out), 1)
    if (blank && ((is_word(last) && is_word(c)) || (last == c && c ~ /[-+]/))) out = out " "
    blank = 0
    if (c == "\"" || c == "'" || (c == "/" && begins_pattern(out))) {
        out = out substr(line, i, end_of(i, c) - i + 1)
        i = end_of(i, c)
        return
    }
    out = out c
    if (c == "`") in_text = 1
    else if (c == "{") ++depth
    else if (c == "}" && top > 0 && levels[top] == depth) { --top; in_text = 1 }
    else if (c == "}") --depth
}

{
    line = $0
    out = ""
    blank = 0
    for (i = 1; i <= length(line); ++i) {
        if (in_text) take_template()
        else if (substr(line, i, 2) == "//") break
        else if (substr(line, i, 1) ~ /[ \t]/) blank = 1
        else take_code()
    }
    print out
}
