# SPDX-License-Identifier: Apache-2.0
# Joins a script of the page with those that it imports, each in a function of its own, in the order in which a browser runs them:
#   awk -v entry=ui/screens.js -v others="main.js net/worker.js" -v scripts="..." -f join_scripts.awk
# in a folder of shortened scripts. What one of `others` imports, too, stays a file. One file is a quarter smaller than its parts: gzip
# finds what they have in common. The paths that are joined go into the file `joined`. Those of `scripts` that are loaded later, by
# import(), get what they import of them from the joined file: they are written anew.

function failed(text) { print "join_scripts.awk: " text > "/dev/stderr"; exit 1 }

# The path in an import of the script `from`, from the folder on.
function imported(from, line,   path) {
    sub(/[^\/]*$/, "", from)
    path = line
    sub(/^[^"]*"/, "", path)
    sub(/".*$/, "", path)
    while (match(path, /^\.\.?\//)) {
        if (RLENGTH == 3) sub(/[^\/]*\/$/, "", from)
        path = substr(path, RLENGTH + 1)
    }
    return from path
}

function names_in(line) { return match(line, /\{[^}]*\}/) ? substr(line, RSTART + 1, RLENGTH - 2) : "" }

function keep_apart(path,   line) {
    if (path in apart) return
    apart[path] = 1
    while ((getline line < path) > 0) if (line ~ /^import[{"]/) keep_apart(imported(path, line))
    close(path)
}

# Names of a file that stays one: imported once for all.
function import_once(path, names,   parts, i, count) {
    count = split(names, parts, ",")
    for (i = 1; i <= count; ++i) {
        if ((path, parts[i]) in outer) continue
        outer[path, parts[i]] = 1
        if (!(path in outer_names)) outer_paths[++outer_count] = path
        outer_names[path] = outer_names[path] "," parts[i]
    }
}

function join(path,   line, target, names, takes, gives, body) {
    begun[path] = 1
    while ((getline line < path) > 0) {
        if (line ~ /^import[{"]/) {
            target = imported(path, line)
            names = names_in(line)
            if (target in apart) { import_once(target, names); continue }
            if (!(target in begun)) join(target)
            else if (!(target in module)) failed(path " and " target " import each other")
            gsub(/ as /, ":", names)
            if (names != "") takes = takes ",{" names "}=" module[target]
            continue
        }
        if (line ~ /^export[ {]/) {
            names = line
            if (names ~ /^export\{/) { names = names_in(names); line = "" }
            else {
                sub(/^export /, "", line)
                sub(/^export (async )?(function\*?|class|const|let) ?/, "", names)
                if (!match(names, /^[A-Za-z0-9_]+/)) failed(path ": " line)
                names = substr(names, 1, RLENGTH)
            }
            gives = gives (gives == "" ? "" : ",") names
        }
        if (line != "") body = body line "\n"
    }
    close(path)
    module[path] = path
    gsub(/[^A-Za-z0-9]/, "_", module[path])
    module[path] = "$" module[path]
    print path > "joined"
    if (takes != "") takes = "const " substr(takes, 2) ";"
    joined = joined (gives == "" ? "" : "const " module[path] "=") "(()=>{" takes "\n" body (gives == "" ? "" : "return{" gives "}") "})();\n"
}

# A script that is loaded later.
function join_late(path,   line, target, names, text, found) {
    while ((getline line < path) > 0) {
        target = line ~ /^import[{"]/ ? imported(path, line) : ""
        if (target in module) {
            names = names_in(line)
            gsub(/ as /, ":", names)
            line = "import" (names == "" ? "" : "{" module[target] "}from") "\"" above(path) entry "\";" (names == "" ? "" : "const{" names "}=" module[target] ";")
            if (names != "" && !(target in late)) {
                late[target] = 1
                gives_late = gives_late "," module[target]
            }
            found = 1
        }
        text = text line "\n"
    }
    close(path)
    if (found) printf "%s", text > path
}

# From the folder of a script to that of the page.
function above(path) {
    gsub(/[^\/]*\//, "../", path)
    sub(/[^\/]*$/, "", path)
    return path
}

BEGIN {
    split(others, roots, " ")
    for (i in roots) keep_apart(roots[i])
    join(entry)
    count = split(scripts, all, " ")
    for (i = 1; i <= count; ++i) if (!(all[i] in module) && !(all[i] in apart)) join_late(all[i])
    for (i = 1; i <= outer_count; ++i) print "import{" substr(outer_names[outer_paths[i]], 2) "}from\"" above(entry) outer_paths[i] "\";"
    printf "%s", joined
    if (gives_late != "") print "export{" substr(gives_late, 2) "};"
}
