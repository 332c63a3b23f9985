// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "registry/history/disk_thread.hpp"
#include "registry/values/recorder.hpp"
#include "registry/values/value_file.hpp"

namespace asip::registry {

/// Keeps values: what a Recorder makes of them is written each ten seconds by a thread of its own, so that a
/// slow, stalled or full disk delays nothing. A file that cannot be used is tried again, in the end each
/// minute; meanwhile changes wait, and beyond Recorder::Options::max_waiting there is a gap. A damaged file
/// is put aside, and a new one begun. All functions and handlers are of the io_context's thread.
class ValueKeeper {
  public:
    struct Handlers {
        std::function<void(const std::string& reason)> failed;
        std::function<void(std::size_t lost)> works_again;
        std::function<void(const std::string& aside, const std::string& damage)> begun_anew;
    };
    static constexpr Duration kWriteInterval = std::chrono::seconds(10);
    /// Where nothing changes: a power cut makes a gap as long as this.
    static constexpr Duration kMarkInterval = std::chrono::minutes(5);
    static constexpr Duration kMaxRetry = std::chrono::minutes(1);
    static constexpr Duration kStalled = std::chrono::seconds(5);  ///< a disk that takes longer
    /// What is asked while the disk takes so long to write is refused.
    static constexpr Duration kPatience = std::chrono::seconds(1);

    ValueKeeper(boost::asio::io_context& io, ValueFile::Options options, Handlers handlers, Instant now);
    /// Writes what waits.
    ~ValueKeeper();
    ValueKeeper(const ValueKeeper&) = delete;
    ValueKeeper& operator=(const ValueKeeper&) = delete;

    /// The value is this from now on; kGap: not known. Kept until drop().
    void set(const PropertyKey& key, double value, Instant now);
    void drop(const PropertyKey& key, Instant now) { recorder_.drop(key, now); }
    /// Call a few times a second.
    void tick(Instant now);

    using Found = std::function<void(bus::Answer)>;
    /// `found` is called at once, or later.
    void find(bus::Query query, Instant now, Found found);

    std::size_t lost() const { return recorder_.dropped() + recorder_.refused() + left_out_; }
    std::size_t kept() const { return recorder_.size(); }
    const std::string& fault() const { return fault_; }

  private:
    struct Work;
    void run(std::shared_ptr<Work> work);
    void perform(Work& work);
    void done(const Work& work);
    void failed(const std::string& why);
    void write(Instant now);
    bool is_slow(Instant now) const { return busy_ && now.time - began_ >= kPatience; }

    boost::asio::io_context& io_;
    const ValueFile::Options options_;
    Handlers handlers_;
    Recorder recorder_;
    std::shared_ptr<ValueRows> rows_;  // not written yet
    std::unique_ptr<ValueFile> file_;  // of the other thread
    std::string fault_;
    Instant now_;
    std::size_t left_out_ = 0, lost_before_ = 0;
    bool busy_ = false;
    Duration retry_ = kWriteInterval;
    Time next_write_{}, next_mark_{}, began_{};
    std::vector<std::shared_ptr<Found>> asked_;  // and not answered
    DiskThread thread_;                          // last: ends first
};

}  // namespace asip::registry
