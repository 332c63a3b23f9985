# SPDX-License-Identifier: Apache-2.0
# Gives the texts of the page short names, a fortieth of the whole: awk -f name_texts.awk languages/en.json FILE. Names with a
# dot are put together while the page runs, and stay as they are.

function short(number) {
    return number < 36 ? substr(digits, number + 1, 1) : short(int(number / 36)) short(number % 36)
}

# The line with each name behind `before` replaced.
function renamed(line, before,    done, name) {
    done = ""
    while (match(line, before)) {
        done = done substr(line, 1, RSTART + RLENGTH - 1)
        line = substr(line, RSTART + RLENGTH)
        name = substr(line, 1, index(line, "\"") - 1)
        if (name in names) {
            done = done names[name]
            line = substr(line, length(name) + 1)
        }
    }
    return done line
}

BEGIN { digits = "0123456789abcdefghijklmnopqrstuvwxyz" }
NR == FNR {
    if (match($0, /^ "[^".]+": /)) names[substr($0, 3, RLENGTH - 5)] = short(count++)
    next
}
FILENAME ~ /\.json$/ && /^ "/ {
    $0 = renamed(substr($0, 2), "^\"")
    sub(/": /, "\":")
}
FILENAME ~ /\.html$/ { $0 = renamed($0, "data-text=\"") }
FILENAME !~ /\.(json|html)$/ { $0 = renamed($0, "(^|[^A-Za-z0-9_.])t\\(\"") }
{ printf "%s%s", $0, FILENAME ~ /\.json$/ ? "" : "\n" }
