#include "nodes/params/join_params.h"

namespace fluidcarve {

void check_join(const JoinParams& params, NodeCheck& check) {
    if (params.join && *params.join != Join::fade && check.stated("fade"))
        check.fault(
            "fade",
            "nothing is blended unless `join` is fade; set `join: fade`, or leave `fade` out");
    // `soft: 0` is the same as a cut.
    const bool soft_cut = params.join == Join::cut && params.soft == 0.0;
    if (params.join && *params.join != Join::squeeze && check.stated("soft") && !soft_cut)
        check.fault("soft",
                    "`soft` is the reach of `join: squeeze`; set that, or leave `soft` out");
    if (!params.join && check.stated("fade") && check.stated("soft"))
        check.fault(
            "soft",
            "`soft` is for `join: squeeze`, `fade` for `join: fade`: leave one of the two out");
}

}  // namespace fluidcarve
