// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/expected.hpp"
#include "asip/model/model_set.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/options.hpp"

namespace asip::cli {

/// The text for standard error (with what to do), and the exit status.
struct Failure {
    int status = program::kExitFailure;
    std::string text;
    std::string reason{};  ///< the word for programs of an agent's refusal: "not-there", "queue-full"
    int code = 0;          ///< of a board's error
};

template <class T>
using Outcome = Expected<T, Failure>;

inline tl::unexpected<Failure> failure(int status, std::string text) {
    return tl::unexpected<Failure>(Failure{status, std::move(text)});
}

/// By Ctrl-C, or the end of the output's reader: nothing is known.
constexpr std::string_view kInterrupted = "interrupted";
inline tl::unexpected<Failure> interrupted() {
    return failure(program::kExitFailure, std::string(kInterrupted));
}

/// Options of every command with their values, without the `--`.
using OptionValues = std::vector<std::pair<std::string, std::string>>;

/// What a command uses of the world.
struct Environment {
    std::istream& in;
    std::ostream& out;  ///< data
    std::ostream& err;  ///< diagnostics

    std::size_t width = 0;    ///< columns of the terminal that `out` is; 0: it is none
    bool colour = false;      ///< use colours on `out`
    int out_descriptor = -1;  ///< file descriptor behind `out`; -1: none

    mqtt::Options mqtt{};
    bus::Topics topics{};
    std::optional<model::ModelSet> own_models{};  ///< standard ones and those of --services
    /// For one answer of broker, registry or board.
    std::chrono::milliseconds timeout{5000};
    bool from_bus = false;  ///< do not ask a registry

    /// The options of every command, with their values.
    OptionValues typed_options{};

    /// The standard ones are read when first asked for.
    const model::ModelSet& models() const { return own_models ? *own_models : model::ModelSet::standard(); }
    /// `asipctl VERB --help`, or the nearest verb.
    std::function<Outcome<std::string>(const std::string& verb)> help{};

    bool terminal() const { return width != 0; }
    /// The reader of the pipe `out` has gone.
    bool reader_gone() const;
    /// The reader has gone, or writing failed.
    bool output_ended() const;
    /// One line, whatever `text` holds.
    void say(const std::string& text) const;
    /// `asipctl: TEXT` on standard error.
    void note(const std::string& text) const;
    /// Returns the status. A reader that has gone is not told.
    int fail_with(const Failure& failure) const;
};

}  // namespace asip::cli
