#pragma once

#include "tests/support/scratch.h"

#include <sys/wait.h>
#include <cstdlib>
#include <string>

/// One finished call of the program, or of any shell command.
struct Called {
    int code = -1;
    std::string out;
    std::string err;
};

/// Runs a shell command in the repository's root, with a work folder of its own unless the command
/// says another.
inline Called call_shell(const std::string& command) {
    const Scratch scratch;
    const int status =
        std::system(("cd " SOURCE_ROOT " && export FLUIDCARVE_WORK=" + (scratch / "work") +
                     " && ( " + command + " ) >" + (scratch / "out") + " 2>" + (scratch / "err"))
                        .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            Scratch::read(scratch / "out"), Scratch::read(scratch / "err")};
}

/// Runs the program that was just built.
inline Called fluidcarve_program(const std::string& arguments) {
    return call_shell(FLUIDCARVE_PROGRAM " " + arguments);
}
