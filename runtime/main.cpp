#include "nodes/catalogue.h"
#include "runtime/commands.h"

int main(int argc, char** argv) { return fluidcarve::run_command_line(argc, argv, fluidcarve::builtin_registry()); }
