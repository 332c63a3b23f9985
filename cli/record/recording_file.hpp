// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <fstream>
#include <functional>
#include <string>

#include "asip/expected.hpp"
#include "asip/time.hpp"
#include "cli/environment.hpp"
#include "cli/record/recording.hpp"

namespace asip::cli {

/// A file that a recording is written to. What was added is handed to the kernel at the latest kWithin later,
/// so that it is there however the program ends; call flush_due() more often than that.
class RecordingWriter {
  public:
    static constexpr std::chrono::milliseconds kWithin{250};

    /// Creates the file; one that exists is replaced only if `replace`, and not before the first flush. "-"
    /// is standard output. Fails with kExitFailure.
    static Outcome<RecordingWriter> create(const std::string& path, bool replace);
    RecordingWriter(RecordingWriter&& other) noexcept;
    RecordingWriter& operator=(RecordingWriter&&) = delete;
    ~RecordingWriter();

    /// Where the next lines are to be appended.
    std::string& text() { return text_; }
    /// Writes if much waits, or for long. Fails where the disk does (full): nothing more can be recorded.
    Expected<void> flush_due(Time now);
    Expected<void> flush();
    std::uint64_t bytes() const { return bytes_; }
    /// Nothing was recorded: leaves no file that was not there.
    void discard();

  private:
    enum class Target { kCreated, kReplaced, kOutput };
    RecordingWriter(int descriptor, Target target, std::string path)
        : descriptor_(descriptor), target_(target), path_(std::move(path)) {}

    int descriptor_;
    Target target_;
    std::string path_;
    std::string text_;
    std::uint64_t bytes_ = 0;
    Time written_{};
};

/// Reads a recording from its beginning, one message after the other, without holding it in memory.
class RecordingReader {
  public:
    static constexpr std::size_t kMaxLineBytes = std::size_t{4} << 20;

    /// Fails with kExitFailure for a file that cannot be read or is no recording.
    static Outcome<RecordingReader> open(const std::string& path);

    /// The next message; nothing at the end. A last line without its end was being written when the recorder
    /// was killed: it ends the recording. Fails with kExitFailure and the number of a line that cannot be
    /// read.
    Outcome<std::optional<RecordedMessage>> next();

  private:
    RecordingReader(std::string path, std::ifstream file) : path_(std::move(path)), file_(std::move(file)) {}

    std::string path_;
    std::ifstream file_;
    std::uint64_t line_ = 1;
};

}  // namespace asip::cli
