// SPDX-License-Identifier: Apache-2.0
// What the Arduino cores of the ESP8266 and the ESP32 declare alike, as far as the library and AsipEsp use
// it: names, types and sizes are theirs, the text is ours. Nothing is defined: it is compiled, and not
// linked.
#pragma once

#include <stddef.h>
#include <stdint.h>

#define HIGH 0x1
#define LOW 0x0
#define PI 3.1415926535897932384626433832795
#define SERIAL 0x0
#define DISPLAY 0x1
#define LSBFIRST 0
#define MSBFIRST 1
#define RISING 0x01
#define FALLING 0x02
#define CHANGE 0x03
#define DEFAULT 1
#define EXTERNAL 0
#define NOT_A_PIN -1
#define NOT_A_PORT -1
#define NOT_AN_INTERRUPT -1
#define NOT_ON_TIMER 0
#define constrain(amt, low, high) ((amt) < (low) ? (low) : ((amt) > (high) ? (high) : (amt)))
#define lowByte(w) ((uint8_t)((w) & 0xff))
#define highByte(w) ((uint8_t)((w) >> 8))
#define bitRead(value, bit) (((value) >> (bit)) & 0x01)
#define bitSet(value, bit) ((value) |= (1UL << (bit)))
#define bit(b) (1UL << (b))
#define _BV(b) (1UL << (b))
#define sq(x) ((x) * (x))

typedef bool boolean;
typedef uint8_t byte;

extern "C" {
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t level);
int digitalRead(uint8_t pin);
unsigned long millis(void);
unsigned long micros(void);
void delay(uint32_t milliseconds);
void yield(void);
}
void setup(void);
void loop(void);
void tone(uint8_t pin, unsigned int frequency, unsigned long duration = 0);
void noTone(uint8_t pin);

class Print {
  public:
    virtual ~Print() {}
    virtual size_t write(uint8_t byte) = 0;
    virtual size_t write(const uint8_t* bytes, size_t size);
    virtual int availableForWrite() { return 0; }
    virtual void flush() {}
};

class Stream : public Print {
  public:
    virtual int available() = 0;
    virtual int read() = 0;
    virtual int peek() = 0;
};

class IPAddress {
  public:
    IPAddress(uint32_t address);
};

class HardwareSerial : public Stream {
  public:
    void begin(unsigned long baud);
    int available() override;
    int read() override;
    int peek() override;
    int availableForWrite() override;
    void flush() override;
    using Print::write;
    size_t write(uint8_t byte) override;
};
extern HardwareSerial Serial;
extern HardwareSerial Serial1;
