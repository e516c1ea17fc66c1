#include "graph/types/plugin.h"

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};
