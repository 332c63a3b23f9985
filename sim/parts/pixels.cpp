// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& pixels_part();

namespace {

/// A strip of WS2812 pixels, which reads the waveform on its pin as they do.
struct PixelsSpec {
    int pin = 0;
    unsigned count = 0;
};

// Times that both the WS2812 and the WS2812B of the data sheets take, in microseconds.
struct Range {
    double min, max;
    bool holds(double value) const { return value >= min && value <= max; }
};
constexpr Range kHighOf0{0.25, 0.50};
constexpr Range kHighOf1{0.65, 0.85};
constexpr double kMinLowAfter0 = 0.70;
constexpr double kMinLowAfter1 = 0.45;
constexpr double kLatchUs = 50;
constexpr unsigned kMaxPixels = 1000;

class Pixels final : public Part {
  public:
    Pixels(std::string name, const PixelsSpec& spec, PartContext& context)
        : Part(std::move(name), pixels_part()),
          context_(context),
          colors_(spec.count),
          latch_(context.clock, [this] { latch(); }) {
        context.wiring.watch(spec.pin, [this](PinState pin) { on_pin(pin.high); });
    }

    /// The colors as red, green, blue, or what was wrong with the last waveform.
    std::string state() const override {
        if (!fault_.empty()) return fault_;
        std::string text;
        for (const auto color : colors_)
            text += fmt::format("{}{:06x}", text.empty() ? "" : " ", color);
        return text;
    }

    void after_reset() override {
        bits_.clear();
        rose_at_ = fell_at_ = 0;
    }

  private:
    void on_pin(bool high) {
        const auto now = context_.clock.cycle();
        if (high == high_) return;
        high_ = high;
        if (high) {
            if (!bits_.empty()) check_low(microseconds(now - fell_at_));
            rose_at_ = now;
            latch_.cancel();
        } else if (rose_at_ != 0) {
            read_bit(microseconds(now - rose_at_));
            fell_at_ = now;
            latch_.at(now + static_cast<std::uint64_t>(kLatchUs * context_.cycles_per_us));
        }
    }

    double microseconds(std::uint64_t cycles) const {
        return static_cast<double>(cycles) / context_.cycles_per_us;
    }

    void check_low(double us) {
        const double least = bits_.back() ? kMinLowAfter1 : kMinLowAfter0;
        if (us < least) new_fault_ = fmt::format("bit {}: low for {:.3f} us", bits_.size() - 1, us);
    }

    void read_bit(double us) {
        if (!kHighOf0.holds(us) && !kHighOf1.holds(us))
            new_fault_ = fmt::format("bit {}: high for {:.3f} us", bits_.size(), us);
        bits_.push_back(us > kHighOf0.max);
    }

    // Each pixel takes the first 24 bits that it gets and hands the others on.
    void latch() {
        const auto before = state();
        if (bits_.size() % 24 != 0 && new_fault_.empty())
            new_fault_ = fmt::format("{} bits, no whole number of pixels", bits_.size());
        for (std::size_t pixel = 0; pixel < std::min(colors_.size(), bits_.size() / 24); ++pixel) {
            std::uint32_t value = 0;
            for (std::size_t bit = 0; bit < 24; ++bit)
                value = value << 1 | (bits_[24 * pixel + bit] ? 1u : 0u);
            colors_[pixel] = (value & 0xff0000) >> 8 | (value & 0xff00) << 8 | (value & 0xff);
        }
        fault_ = std::exchange(new_fault_, {});
        bits_.clear();
        rose_at_ = 0;
        if (state() != before) context_.changed(*this);
    }

    PartContext& context_;
    std::vector<std::uint32_t> colors_;
    Alarm latch_;
    std::vector<bool> bits_;
    bool high_ = false;
    std::uint64_t rose_at_ = 0;
    std::uint64_t fell_at_ = 0;
    std::string fault_;
    std::string new_fault_;
};

PartPlan read_pixels(PartReader& reader) {
    const PixelsSpec spec{reader.pin("pin"),
                          static_cast<unsigned>(reader.number("count", 18, 1, kMaxPixels))};
    return {.claims = {{spec.pin, PinUse::kListens}}, .timers = 1, .make = maker<Pixels>(spec)};
}

}  // namespace

const PartKind& pixels_part() {
    static constexpr PartKind kind{"pixels", {}, read_pixels};
    return kind;
}

}  // namespace asip::sim
