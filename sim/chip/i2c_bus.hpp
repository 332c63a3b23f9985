// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "sim/chip/alarm.hpp"
#include "sim/chip/simavr.hpp"
#include "sim/wiring/wiring.hpp"

namespace asip::sim {

/// As the master sees it.
class I2cDevice {
  public:
    virtual ~I2cDevice() = default;
    /// Seven bits. A detached one acknowledges nothing.
    virtual std::uint8_t address() const = 0;
    virtual bool is_there() const = 0;
    /// False: its address is not acknowledged for a read.
    virtual bool is_ready_to_read() const { return true; }
    /// A transfer begins or goes on the other way.
    virtual void started(bool reading) = 0;
    /// False: not acknowledged.
    virtual bool write(std::uint8_t byte) = 0;
    virtual std::uint8_t read() = 0;
};

/// The chip's I2C master (TWI) by its data sheet, as simavr's is five times too fast, and the devices. A
/// device that was cut off while it was read holds SDA low until nine clocks.
class I2cBus {
  public:
    /// Arduino pins of SDA and SCL. Does nothing for a chip without TWI.
    I2cBus(AlarmClock& clock, Wiring& wiring, int data, int clock_pin);

    bool exists() const { return port_ != nullptr; }
    void attach(I2cDevice& device) { devices_.push_back(&device); }

    /// After simavr's own reset.
    void after_reset();

  private:
    enum class Step { kNone, kStart, kAddress, kWrite, kRead, kStop };

    static void write_control(avr_t* avr, avr_io_addr_t address, std::uint8_t value, void* param);
    void control(std::uint8_t value);
    void begin(Step step, double bits);
    void on_alarm();
    void finish_start();
    void finish_address();
    void finish_write();
    void finish_read();
    void finish_stop();
    void report(std::uint8_t status);
    bool is_stuck() const;
    void hold_data(bool on);
    void on_clock_pin(PinState pin);
    I2cDevice* find(std::uint8_t address);
    double bit_cycles() const;
    std::uint8_t& data(avr_io_addr_t address) const { return clock_.avr().data[address]; }

    AlarmClock& clock_;
    Wiring& wiring_;
    int data_pin_, clock_pin_;
    avr_twi_t* port_ = nullptr;
    Alarm alarm_;
    std::vector<I2cDevice*> devices_;
    I2cDevice* device_ = nullptr;  // addressed now
    Step step_ = Step::kNone;
    bool owned_ = false;  // between start and stop
    bool reading_ = false;
    bool addressing_ = false;  // the next byte is an address
    bool start_follows_ = false;
    int clocks_to_release_ = 0;
};

}  // namespace asip::sim
