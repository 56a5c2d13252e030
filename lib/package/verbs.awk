# `gtx VERB --help` of every verb, one after another -> the VERBS section of the man page.
function quote(text) # for troff: dashes are minus signs, and no line starts with a request
{
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    return (text ~ /^[.']/ ? "\\&" : "") text
}
/^gtx / { print ".SS " quote($0); next }
/^  / {
    at = match($0, /[^ ]   *[^ ]/) # an option and its meaning are two spaces apart
    option = substr($0, 1, at); sub(/^ */, "", option); print ".TP\n.B " quote(option)
    print quote(substr($0, at + RLENGTH - 1))
    next
}
NF { print quote($0) }
