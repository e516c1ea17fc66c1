#pragma once

#include "tools/draft/contents.h"
#include "tools/draft/draft.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Whether a text can be the name of a reader's output in a pipeline.
bool plain_name(const std::string& name);

/// Writes one pipeline.
class DraftText {
public:
    using Matter = Contents::Matter;
    using Fields = DraftRequest::Fields;

    DraftText(const DraftRequest& request);

    std::string text();

private:
    // Lines of the file.

    void comment(const std::string& text);
    void more(const std::string& text);
    void node(const std::string& name, const std::string& type, const Fields& fields);

    /// The line of a param; none without a value.
    static std::string param(const char* name, const char* type, const std::string& value,
                             const char* doc);
    static std::string path_param(const char* name, const std::string& value, const char* doc);
    /// Whether the count is no whole number.
    bool fraction() const;

    std::string head() const;
    std::string frames() const;

    /// @throws Failure if there are no frames to take or to add, or the request has no time
    void require_time() const;
    int frame_count() const;  ///< of the input
    int frames_more() const;  ///< that the count adds; below 0: takes
    /// Whether the whole sequence changes its pace, since seams of frames do not suit it: they tear
    /// water, follow meshes badly, and can't show a frame more than twice.
    bool paced() const;
    /// A pipeline that makes the sequence faster or slower.
    std::string at_another_pace();
    /// Nodes that give it its length, and write it.
    void paced_volume();
    void paced_particles();
    void paced_mesh();
    /// Surfaces are seen from above, where they have their waves; all else from the front.
    void paced_sheet(const char* shown, const std::string& grid);

    // Parts that all pipelines have.

    /// Names a float grid, a vector grid or a channel as an output of the reader.
    /// @return "sim.NAME"
    std::string offer(const std::string& grid, const std::string& name, const char* type);

    /// The reader of the files, with what was offered so far.
    void reader(const char* type, const char* list);

    /// Offers the grids that have the name of the one that is looked at.
    void beside();

    /// The nodes of masks that no seam may pass. @param like  a grid on whose voxels they lie
    void masks(const std::string& like);

    void box(const std::string& fit);

    /// What stands in place of the box where the content bends: a rig through its middle, in its
    /// longest direction.
    void rig_comment();

    /// Whether a warp carves, not seams. In a wave, a seam would be a cliff.
    bool warps() const;
    /// Without the fields of a name.
    static Fields without(Fields fields, std::string_view name);

    void solver(Fields fields);

    void carve(const std::string& name, const char* type, const std::string& source, Fields fields);

    /// Fields, some of them with other values.
    static Fields with(Fields fields, const Fields& wanted);

    /// The writers of all but the carved files.
    void others(const std::string& before, const std::string& after, const std::string& grid);

    /// What is protected: a range of a grid's values, or what is in a file.
    struct Protected {
        std::string field;  ///< output of the reader; empty: a file
        std::string value;  ///< lowest value, or path
    };

    void read_protected();

    // A pipeline for each matter.

    /// The reader of .vdb files.
    void volume_reader();
    /// Carves and writes all grids of .vdb files.
    void carve_volume();

    void fog();
    void level_set();
    void particles();
    void image();
    void mesh();

    const DraftRequest& request_;
    char axis_ = 'x';  ///< x, y, z or t
    const Contents contents_;
    /// Outputs of the reader, and what they are, as YAML.
    std::vector<std::pair<std::string, std::string>> offered_;
    std::vector<Protected> protected_;
    std::string nodes_;
};

}  // namespace fluidcarve
