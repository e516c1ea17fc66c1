#include "carve/base/failure.h"
#include "formats/file/module.h"
#include "nodes/expression/expression.h"
#include "nodes/expression/module/checker.h"
#include "nodes/expression/module/rewriter.h"

#include <fmt/format.h>
#include <openvdb_ax/ax.h>
#include <openvdb_ax/compiler/Compiler.h>
#include <openvdb_ax/compiler/VolumeExecutable.h>

#include <mutex>

namespace fluidcarve {
namespace {

namespace ax = openvdb::ax;

/// Maximum size of a program: parser and compiler are recursive.
constexpr std::size_t most_bytes = 16 << 10;

/// A compiled program as an AX executable.
struct Executable : CompiledExpression {
    ax::VolumeExecutable::Ptr program;
};

/// Compiles a program that has passed the check.
/// @return null if AX refuses it; `faults` says why
ax::VolumeExecutable::Ptr program_of(const Expression& expression, const ExpressionSource& source,
                                     const ExpressionChecker& checker,
                                     std::vector<ExpressionFault>& faults) {
    const auto before = faults.size();
    // The first message only: the others mostly follow from it.
    ax::Logger logger([&](const std::string& message) {
        if (faults.size() == before) faults.push_back(fault_of(message));
    });
    logger.setNumberedOutput(false);
    logger.setErrorPrefix("");
    try {
        const auto tree = rewritten(expression, source, checker.reads(), logger);
        return ax::Compiler().compile<ax::VolumeExecutable>(*tree, logger);
    } catch (const openvdb::Exception& error) {
        if (faults.size() == before) faults.push_back({"code", 0, 0, error.what()});
    }
    return nullptr;
}

std::shared_ptr<const CompiledExpression> compile(const Expression& expression,
                                                  std::vector<ExpressionFault>& faults) {
    // Neither the parser nor the start of LLVM is thread-safe.
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    if (!ax::isInitialized()) ax::initialize();

    const auto before = faults.size();
    if (expression.code.size() > most_bytes) {
        faults.push_back(
            {"code", 0, 0,
             fmt::format("has {} bytes; {} are the most", expression.code.size(), most_bytes)});
        return nullptr;
    }
    const ExpressionSource source(expression.code, faults);
    if (!source) return nullptr;
    ExpressionChecker checker(expression, source, faults);
    checker.check();
    if (faults.size() > before) return nullptr;

    const auto out = std::make_shared<Executable>();
    out->program = program_of(expression, source, checker, faults);
    if (faults.size() > before || !out->program) return nullptr;
    checker.warn_of_unread();
    out->reads = checker.reads();
    out->asks_where = checker.asks_where();
    // By default AX creates a grid of zeros for an unknown name.
    out->program->setCreateMissing(false);
    using Streaming = ax::VolumeExecutable::Streaming;
    out->program->setActiveTileStreaming(out->asks_where ? Streaming::ON : Streaming::OFF);
    return out;
}

void run(const CompiledExpression& program, const std::vector<NamedGrid>& inputs, FloatGrid& out) {
    openvdb::GridPtrVec grids;
    for (const auto& [name, grid] : inputs) {
        // A second grid with the same tree. AX only reads the tree.
        grids.push_back(openvdb::ConstPtrCast<openvdb::GridBase>(grid)->copyGrid());
        grids.back()->setName(name);
    }
    // The caller owns the grid.
    grids.emplace_back(&out, [](openvdb::GridBase*) {});
    try {
        static_cast<const Executable&>(program).program->execute(grids);
    } catch (const openvdb::Exception& error) {
        throw Failure(fmt::format("the program can't run: {}", error.what()));
    }
}

const ExpressionModule functions{compile, run};

}  // namespace

extern "C" {
extern const Module fluidcarve_module;
const Module fluidcarve_module{FLUIDCARVE_VERSION, &functions};
}

}  // namespace fluidcarve
