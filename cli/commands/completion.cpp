// SPDX-License-Identifier: Apache-2.0
#include <ostream>

#include "cli/declaration.hpp"
#include "cli/environment.hpp"

namespace asip::cli {
namespace {

constexpr const char* kBashScript =
    R"script(# Completion of asipctl for bash:  source <(asipctl completion bash)
_asipctl() {
    local program=${1/#\~/$HOME} found
    COMPREPLY=()
    # Each line as it is: bash expands words that are not read.
    while IFS= read -r found; do
        COMPREPLY+=("$found")
    done < <("$program" __complete bash "${COMP_LINE:0:COMP_POINT}" 2>/dev/null)
    case ${COMPREPLY[0]} in
        :files) COMPREPLY=(); compopt -o default 2>/dev/null ;;
        :folders) COMPREPLY=(); compopt -o dirnames 2>/dev/null ;;
        # A board may be followed by a service: no blank after BOARD/.
        */) if [[ ${#COMPREPLY[@]} -eq 1 ]]; then compopt -o nospace 2>/dev/null; fi ;;
    esac
}
complete -F _asipctl asipctl
)script";

constexpr const char* kZshScript = R"script(#compdef asipctl
# Completion of asipctl for zsh:  source <(asipctl completion zsh)
_asipctl() {
    local -a found whole open
    found=("${(@f)$(${~words[1]} __complete zsh "${(j: :)words[1,CURRENT-1]} $PREFIX" 2>/dev/null)}")
    case ${found[1]} in
        :files) _files; return ;;
        :folders) _files -/; return ;;
    esac
    whole=(${found:#*/})
    open=(${(M)found:#*/})
    (( ${#whole} )) && compadd -a whole
    (( ${#open} )) && compadd -S '' -a open
}
compdef _asipctl asipctl
)script";

constexpr const char* kFishScript =
    R"script(# Completion of asipctl for fish:  asipctl completion fish | source
function __asipctl_complete
    set -l found (asipctl __complete fish (commandline -cp) 2>/dev/null)
    switch "$found[1]"
        case ':files'
            __fish_complete_path (commandline -ct)
        case ':folders'
            __fish_complete_directories (commandline -ct)
        case '*'
            printf '%s\n' $found
    end
end
complete -c asipctl -f -a '(__asipctl_complete)'
)script";

const char* script_for(const std::string& shell) {
    if (shell == "fish") return kFishScript;
    return shell == "zsh" ? kZshScript : kBashScript;
}

Run declare_completion(Declaration& verb) {
    auto shell = std::make_shared<std::string>();
    verb.argument("bash|fish|zsh", *shell, "For which shell");
    return [shell](Environment& environment) {
        environment.out << script_for(*shell) << std::flush;
        return program::kExitOk;
    };
}

}  // namespace

Verb completion_verb() {
    return {"completion", "Script that completes commands, boards, services and their commands",
            "Examples:\n"
            "  source <(asipctl completion bash)\n"
            "  asipctl completion fish > ~/.config/fish/completions/asipctl.fish\n"
            "  asipctl completion zsh > ~/.zfunc/_asipctl",
            declare_completion, false};
}

}  // namespace asip::cli
