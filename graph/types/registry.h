#pragma once

#include "graph/types/contact_sheet.h"
#include "graph/types/draft.h"
#include "graph/types/file_comparer.h"
#include "graph/types/node_type.h"
#include "graph/types/page_joiner.h"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Inspects one kind of file for `fluidcarve inspect`. The files may be damaged.
struct FileInspector {
    std::vector<std::string> endings;     ///< file extensions: ".vdb"
    std::vector<std::string> not_carved;  ///< those of the endings whose files hold nothing to carve
    std::string parts;                    ///< field of `look`'s result with the list of what is in the file, each with a `name`: "grids"
    /// Reads a file and describes its content. Called in a child process, since damaged files may crash it. @throws Failure
    std::function<nlohmann::ordered_json(const std::string& path)> look;
    /// Compares the results of `look` for several files, in order. One line per finding.
    std::function<std::vector<std::string>(const std::vector<nlohmann::ordered_json>&)> compare;
    /// The result of `look` as text for people. Of a sequence, numbers that change are lists of the least and the greatest.
    std::function<std::string(const nlohmann::ordered_json&)> text;
};

/// Reads what a file states of how it was made, for `fluidcarve explain`. The file may be damaged.
struct ProvenanceReader {
    /// Called in a child process, since damaged files may crash it. Empty: the file states nothing. @throws Failure
    std::function<Provenance(const std::string& path)> read;
};

/// The node types, payload types, conversions and selections that a pipeline may use, and what looks into files and compares them. A plain
/// value that the program, or a test, fills.
class Registry {
public:
    /// @throws std::logic_error if the name is taken, a doc string is empty, or a port's payload type is not registered
    void add(NodeType type);
    void add(PayloadType type);
    void add(Conversion conversion);
    void add(Selection selection);
    void add(FileInspector inspector) { inspectors_.push_back(std::move(inspector)); }
    void add(ProvenanceReader reader) { provenance_reader_ = std::move(reader); }
    void add(PipelineDrafter drafter) { drafter_ = std::move(drafter); }
    void add(ContactSheetWriter writer) { contact_sheet_ = std::move(writer); }
    void add(PageJoiner joiner) { page_joiner_ = std::move(joiner); }
    void add(FileComparer comparer) { comparers_.push_back(std::move(comparer)); }

    const NodeType* node(std::string_view name) const;
    std::vector<std::string> node_names() const;  ///< sorted
    std::vector<std::string> families() const;    ///< of node types: "mask"; sorted
    const PayloadType& payload(std::type_index type) const;
    const std::map<std::string, NodeType, std::less<>>& nodes() const { return nodes_; }
    const std::vector<PayloadType>& payloads() const { return payloads_; }
    const std::vector<FileInspector>& inspectors() const { return inspectors_; }
    /// The inspector for a file, by its ending; null: none.
    const FileInspector* inspector(const std::string& path) const;
    const ProvenanceReader& provenance_reader() const { return provenance_reader_; }
    const PipelineDrafter& drafter() const { return drafter_; }
    const ContactSheetWriter& contact_sheet() const { return contact_sheet_; }
    const PageJoiner& page_joiner() const { return page_joiner_; }
    const std::vector<FileComparer>& comparers() const { return comparers_; }

    /// Whether an input of type `to` takes a payload of type `from`, with or without a conversion.
    bool accepts(std::type_index to, std::type_index from) const;
    Payload convert(const Payload& payload, std::type_index to) const;
    /// The way from payloads of a type to parts that an input of type `to` takes; null if there is none.
    const Selection* selection(std::type_index from, std::type_index to) const;
    /// Names of all payload types that an input of the type takes: "volume, float or vector".
    std::string accepted_names(std::type_index to) const;

private:
    const Conversion* conversion(std::type_index from, std::type_index to) const;
    std::map<std::string, NodeType, std::less<>> nodes_;
    std::vector<PayloadType> payloads_;
    std::vector<Conversion> conversions_;
    std::vector<Selection> selections_;
    std::vector<FileInspector> inspectors_;
    ProvenanceReader provenance_reader_;
    PipelineDrafter drafter_;
    ContactSheetWriter contact_sheet_;
    PageJoiner page_joiner_;
    std::vector<FileComparer> comparers_;
};

}  // namespace fluidcarve
