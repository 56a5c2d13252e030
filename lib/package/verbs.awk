# `gtx VERB --help` of every verb, one after another -> the VERBS section of the man page.
function quote(text) # for troff: dashes are minus signs, and no line starts with a request
{
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    return (text ~ /^[.']/ ? "\\&" : "") text
}
/^gtx / { print ".SS " quote($0); next }
/^          / { # the meaning of the option on the line before
    sub(/^ */, ""); print quote($0)
    next
}
/^  / {
    at = match($0, /[^ ]   *[^ ]/) # an option and its meaning are two spaces apart
    option = at ? substr($0, 1, at) : $0; sub(/^ */, "", option); print ".TP\n.B " quote(option)
    if (at)
        print quote(substr($0, at + RLENGTH - 1))
    next
}
NF { print quote($0) }
