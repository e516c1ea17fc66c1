#include "formats/vdb/provenance_metadata.h"

namespace fluidcarve {

void set_provenance(openvdb::MetaMap& metadata, const Provenance& provenance) {
    for (const auto name : provenance_names) metadata.removeMeta(std::string(name));
    for (const auto& [name, text] : provenance)
        metadata.insertMeta(name, openvdb::StringMetadata(text));
}

Provenance provenance_in(const openvdb::MetaMap& metadata) {
    Provenance out;
    for (const auto name : provenance_names)
        if (const auto text = metadata.getMetadata<openvdb::StringMetadata>(std::string(name)))
            out.emplace_back(name, text->value());
    return out;
}

}  // namespace fluidcarve
