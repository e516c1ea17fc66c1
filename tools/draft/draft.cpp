#include "tools/draft/draft.h"

#include "tools/draft/draft_text.h"

namespace fluidcarve {

std::string draft_pipeline(const DraftRequest& request) { return DraftText(request).text(); }

}  // namespace fluidcarve
