# SPDX-License-Identifier: MIT
# Completion of l1l2stab for fish. The options and their values come from the program itself.
for line in (command l1l2stab --complete 2>/dev/null)
    set -l words (string split --no-empty ' ' -- $line)
    set -l name (string replace -- '--' '' $words[1])
    switch "$words[2]"
        case ''
            complete -c l1l2stab -l $name
        case FILE
            complete -c l1l2stab -l $name -r -F
        case DIR
            complete -c l1l2stab -l $name -x -a '(__fish_complete_directories)'
        case VALUE
            complete -c l1l2stab -l $name -x
        case '*'
            complete -c l1l2stab -l $name -x -a "$words[2..]"
    end
end
