# Writes each C++ block of a Markdown file that opens with a comment naming a path to that path below `folder`.
/^```cpp$/ { inside = 1; path = ""; next }
/^```$/ { if (path != "") close(path); inside = 0; path = ""; next }
inside && path == "" {
    if ($1 == "//") {
        path = folder "/" $2
        parent = path
        sub(/\/[^\/]*$/, "", parent)
        system("mkdir -p " parent)
        printf "" > path
    }
    next
}
inside && path != "" { print >> path }
