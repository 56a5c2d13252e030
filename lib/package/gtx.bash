# Completion of the gtx command in bash: all that is known is asked of `gtx help`. In zsh:
# autoload -U bashcompinit && bashcompinit, then source this file.
_gtx()
{
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]}
    local gtx=${COMP_WORDS[0]} words
    if [ "$COMP_CWORD" = 1 ] || { [ "$COMP_CWORD" = 2 ] && [ "$verb" = help ]; }; then
        words="help $("$gtx" help 2>/dev/null | sed -n 's/^  \([a-z]*\) .*/\1/p')"
    elif [[ $word == -* ]]; then
        words=$("$gtx" help "$verb" 2>/dev/null |
                sed -n 's/^  \(-[a-z], \|    \)\(--[a-z0-9-]*\).*/\2/p')
    else # one of few values, or a file
        words=$("$gtx" help "$verb" 2>/dev/null |
                sed -n "s/^ *$before \([a-z0-9]*|[a-z0-9|]*\).*/\1/p" | tr '|' ' ')
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _gtx gtx
