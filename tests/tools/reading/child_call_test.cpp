#include "tools/reading/child_call.h"

#include <catch2/catch.hpp>

#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <vector>

using namespace fluidcarve;

namespace {

constexpr std::uint64_t plenty = std::uint64_t{4} << 30;

ChildResult call(const std::function<std::string()>& body, double seconds = 20) {
    return call_in_child(body, plenty, seconds);
}

}  // namespace

TEST_CASE("a confined call hands back what it returns, however long, and what it throws") {
    const std::string text(300000, 'x');
    const auto returned = call([&] { return text; });
    CHECK(returned.end == ChildResult::End::returned);
    CHECK(returned.text == text);
    const auto threw = call([]() -> std::string { throw std::runtime_error("no such thing"); });
    CHECK(threw.end == ChildResult::End::threw);
    CHECK(threw.text == "no such thing");
}

TEST_CASE("a confined call that crashes or never ends takes nothing down with it") {
    const auto crashed = call([]() -> std::string {
        raise(SIGKILL);
        return {};
    });
    CHECK(crashed.end == ChildResult::End::crashed);
    CHECK(crashed.text == "Killed");
    const auto hung = call(
        []() -> std::string {
            while (true) pause();
        },
        0.2);
    CHECK(hung.end == ChildResult::End::too_slow);
    CHECK(call([]() -> std::string { _exit(0); }).end == ChildResult::End::crashed);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("a confined call gets no more memory than it is granted") {
    const auto greedy = call_in_child([] { return std::string(std::size_t{2} << 30, 'x'); },
                                      std::uint64_t{1} << 30, 20);
    CHECK(greedy.end == ChildResult::End::threw);
    CHECK(greedy.text == "it needs more memory than is allowed");
}
#endif
