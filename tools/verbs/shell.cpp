#include "tools/verbs/verbs.h"

#include "runtime/tell/exit_codes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <sstream>
#include <string>
#include <vector>

namespace fluidcarve {
namespace {

/// Escapes a text for roff.
std::string roff(const std::string& text) {
    std::string out;
    bool begins = true;
    for (const char c : text) {
        if (begins && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\') out += "\\e";
        else if (c == '-') out += "\\-";
        else out += c;
        begins = c == '\n';
    }
    return out;
}

std::vector<const CLI::App*> verbs(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}
std::vector<const CLI::Option*> options(const CLI::App& app) {
    return app.get_options([](const CLI::Option*) { return true; });
}

/// An option as in help texts: "-f, --frames FRAMES"; a positional argument by its type name.
std::string spelling(const CLI::Option& option) {
    std::string out;
    for (const auto& name : option.get_snames()) out += (out.empty() ? "-" : ", -") + name;
    for (const auto& name : option.get_lnames()) out += (out.empty() ? "--" : ", --") + name;
    // CLI11 appends the choices of a check to the type name: "TEXT:{auto,bar}".
    const auto type = option.get_type_name().substr(0, option.get_type_name().find(':'));
    if (out.empty()) return type;
    return option.get_expected_max() == 0 || type.empty() ? out : out + " " + type;
}

/// Choices of an option, from the braces in its type name: "{auto,bar}".
std::vector<std::string> choices(const CLI::Option& option) {
    const auto text = option.get_type_name();
    const auto begin = text.rfind('{'), end = text.rfind('}');
    std::vector<std::string> out;
    if (begin == std::string::npos || end == std::string::npos || end < begin) return out;
    std::istringstream in(text.substr(begin + 1, end - begin - 1));
    for (std::string item; std::getline(in, item, ',');) out.push_back(item);
    return out;
}

std::string joined(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, " "));
}

std::vector<std::string> flags_of(const CLI::App& app) {
    std::vector<std::string> out;
    for (const auto* const option : options(app)) {
        for (const auto& name : option->get_lnames()) out.push_back("--" + name);
        for (const auto& name : option->get_snames()) out.push_back("-" + name);
    }
    return out;
}

/// What completes a word, as shell code that bash and zsh share: it sets `chosen` to the words that
/// may stand here, and leaves it empty for files. It reads `word`, `before` (the word before),
/// `verb`, and `at` (the word's index).
std::string chosen_words(const CLI::App& app) {
    std::vector<std::string> names;
    std::string flags, values;
    for (const auto* const verb : verbs(app)) {
        names.push_back(verb->get_name());
        flags += fmt::format("        {}) chosen=\"{}\" ;;\n", verb->get_name(),
                             joined(flags_of(*verb)));
        for (const auto* const option : options(*verb))
            if (const auto all = choices(*option); !all.empty())
                values +=
                    fmt::format("        {}:{}) chosen=\"{}\" ;;\n", verb->get_name(),
                                option->get_lnames().empty() ? verb->get_name()
                                                             : "--" + option->get_lnames().front(),
                                joined(all));
    }
    return fmt::format(R"(    if [ "$at" -eq 1 ]; then
        chosen="{} --help --version"
    elif [[ "$word" == -* ]]; then
        case "$verb" in
{}        esac
    else
        case "$verb:$before" in
        nodes:nodes) chosen=$(fluidcarve nodes | awk 'NF{{print $1}}') ;;
{}        esac
    fi
)",
                       joined(names), flags, values);
}

std::string bash_completion(const CLI::App& app) {
    return fmt::format(R"(_fluidcarve() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
    local verb=${{COMP_WORDS[1]}} at=$COMP_CWORD chosen=""
{}    if [ -n "$chosen" ]; then COMPREPLY=($(compgen -W "$chosen" -- "$word"))
    else COMPREPLY=($(compgen -f -- "$word")); fi
}}
complete -o filenames -F _fluidcarve fluidcarve
)",
                       chosen_words(app));
}

/// Works as a file in `fpath`, where the first completion runs it, and as a script that is sourced.
std::string zsh_completion(const CLI::App& app) {
    return fmt::format(R"(#compdef fluidcarve
_fluidcarve() {{
    local word=${{words[CURRENT]}} before=${{words[CURRENT-1]}} verb=${{words[2]}}
    local at=$((CURRENT - 1)) chosen=""
{}    if [ -n "$chosen" ]; then compadd -- ${{=chosen}}; else _files; fi
}}
if [ "${{funcstack[1]}}" = _fluidcarve ]; then _fluidcarve "$@"
else compdef _fluidcarve fluidcarve; fi
)",
                       chosen_words(app));
}

/// A text as a word of fish.
std::string fish_word(const std::string& text) {
    std::string out = "'";
    for (const char c : text)
        out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return out + "'";
}

std::string fish_completion(const CLI::App& app) {
    std::string out =
        "complete -c fluidcarve -n __fish_use_subcommand -f -l help\ncomplete -c fluidcarve -n "
        "__fish_use_subcommand -f -l version\n";
    for (const auto* const verb : verbs(app)) {
        out += fmt::format("complete -c fluidcarve -n __fish_use_subcommand -f -a {} -d {}\n",
                           verb->get_name(), fish_word(verb->get_description()));
        for (const auto* const option : options(*verb)) {
            const auto all = choices(*option);
            const bool positional = option->get_lnames().empty() && option->get_snames().empty();
            if (positional && all.empty()) continue;
            out += fmt::format("complete -c fluidcarve -n '__fish_seen_subcommand_from {}'",
                               verb->get_name());
            for (const auto& name : option->get_snames()) out += " -s " + name;
            for (const auto& name : option->get_lnames()) out += " -l " + name;
            // -x: one of these; -r: a value, which may be a file; -f: no value.
            if (!all.empty())
                out += fmt::format(" {} -a {}", positional ? "-f" : "-x", fish_word(joined(all)));
            else if (option->get_expected_max() != 0) out += " -r";
            out += fmt::format(" -d {}\n", fish_word(option->get_description()));
        }
    }
    return out +
           "complete -c fluidcarve -n '__fish_seen_subcommand_from nodes' -f -a '(fluidcarve nodes "
           "| string match -r \"[^ ]+\")'\n";
}

/// The manual page of a program with verbs, in roff, generated from its command line.
std::string man_page(const CLI::App& app, const std::string& version) {
    std::string out = fmt::format(
        ".TH FLUIDCARVE 1 \"\" \"fluidcarve {}\"\n.SH NAME\nfluidcarve \\- change the size of a "
        "finished simulation\n",
        version);
    out += ".SH SYNOPSIS\n.B fluidcarve\n.I VERB\n[\n.I options\n]\n.SH DESCRIPTION\n" +
           roff(app.get_description()) + "\n.SH VERBS\n";
    for (const auto* const verb : verbs(app)) {
        out += fmt::format(".SS {}\n{}.\n", roff(verb->get_name()), roff(verb->get_description()));
        for (const auto* const option : options(*verb)) {
            out += fmt::format(".TP\n.B {}\n{}", roff(spelling(*option)),
                               roff(option->get_description()));
            if (const auto all = choices(*option); !all.empty())
                out += fmt::format(" ({})", roff(joined(all)));
            if (!option->get_default_str().empty())
                out += fmt::format(" [{}]", roff(option->get_default_str()));
            if (!option->get_envname().empty())
                out += fmt::format("; environment: {}", roff(option->get_envname()));
            out += "\n";
        }
        if (!verb->get_footer().empty()) out += ".PP\n.nf\n" + roff(verb->get_footer()) + "\n.fi\n";
    }
    out += ".SH EXIT STATUS\n";
    for (const auto& [code, meaning] : exit_code::meanings)
        out += fmt::format("{}{} {}", code == exit_code::done ? "" : "; ", code, meaning);
    out += ".\n";
    return out + ".SH SEE ALSO\n" +
           roff("`fluidcarve nodes` lists all node types, `fluidcarve nodes TYPE` describes one.") +
           "\n";
}

/// A script that completes verbs, options and their choices, and file names for all other
/// arguments.
/// @param shell  "bash", "zsh" or "fish"
std::string completion(const CLI::App& app, const std::string& shell) {
    if (shell == "fish") return fish_completion(app);
    return shell == "zsh" ? zsh_completion(app) : bash_completion(app);
}

}  // namespace

Verb::Work man_verb(CLI::App&, Program& program) {
    return [&program] { return print(man_page(program.app, FLUIDCARVE_VERSION)), exit_code::done; };
}

Verb::Work completion_verb(CLI::App& verb, Program& program) {
    const auto shell = std::make_shared<std::string>();
    verb.add_option("shell", *shell, "The shell")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}))
        ->type_name("SHELL");
    return [=, &program] { return print(completion(program.app, *shell)), exit_code::done; };
}

}  // namespace fluidcarve
