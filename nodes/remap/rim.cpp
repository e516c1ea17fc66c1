#include "nodes/remap/rim.h"

#include "graph/types/node_type.h"

namespace fluidcarve {

void check_fade(Rim rim, NodeCheck& check) {
    if (rim == Rim::cut && check.stated("fade")) check.fault("fade", "nothing fades while `rim` is cut; set `rim: fade`, or leave `fade` out");
}

}  // namespace fluidcarve
