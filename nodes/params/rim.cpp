#include "nodes/params/rim.h"

#include "graph/types/node_type.h"

namespace fluidcarve {

void check_rim_fade(Rim rim, NodeCheck& check) {
    if (rim == Rim::cut && check.stated("rim_fade"))
        check.fault("rim_fade",
                    "nothing fades while `rim` is cut; set `rim: fade`, or leave `rim_fade` out");
}

}  // namespace fluidcarve
