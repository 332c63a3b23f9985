// SPDX-License-Identifier: Apache-2.0
// A sketch that does what a test asks for over the serial port: the tests of the simulator look at one chip
// feature at a time, without a firmware's own ideas in between. Every command is a letter and its binary
// arguments.
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdint.h>
#include <util/delay.h>

#ifdef UCSR0A
#define STATUS UCSR0A
#define CONTROL UCSR0B
#define BAUD_LOW UBRR0L
#define BAUD_HIGH UBRR0H
#define DATA UDR0
#else
#define STATUS UCSR1A
#define CONTROL UCSR1B
#define BAUD_LOW UBRR1L
#define BAUD_HIGH UBRR1H
#define DATA UDR1
#endif
#define BIT_RXC 7
#define BIT_TXC 6
#define BIT_UDRE 5
#define BIT_FE 4

static uint8_t get(void) {
    while (!(STATUS & (1 << BIT_RXC)))
        ;
    return DATA;
}

static void put(uint8_t value) {
    while (!(STATUS & (1 << BIT_UDRE)))
        ;
    STATUS = (1 << BIT_TXC) | (1 << 1);
    DATA = value;
}

static uint16_t get16(void) {
    uint8_t low = get();
    return low | (uint16_t)get() << 8;
}

static void put16(uint16_t value) {
    put((uint8_t)value);
    put((uint8_t)(value >> 8));
}

// 'U': a trigger pulse on D4 (PD4), then the echo on the same pin, in timer ticks of 0.5 us. 'u': echo on D5
// (PD5).
static uint16_t echo(uint8_t bit) {
    TCCR1A = 0;
    TCCR1B = 1 << CS11;
    DDRD |= 1 << 4;
    PORTD |= 1 << 4;
    _delay_us(10);
    PORTD &= (uint8_t)~(1 << 4);
    DDRD &= (uint8_t)~(1 << 4);
    TCNT1 = 0;
    while (!(PIND & (1 << bit)))
        if (TCNT1 > 60000) return 0;
    TCNT1 = 0;
    while (PIND & (1 << bit))
        ;
    return TCNT1;
}

// 'S': one servo pulse on D9 (PB1 of an Uno).
static void pulse(uint16_t microseconds) {
    TCCR1A = 0;
    TCCR1B = 1 << CS11;
    DDRB |= 1 << 1;
    PORTB |= 1 << 1;
    TCNT1 = 0;
    while (TCNT1 < 2 * microseconds)
        ;
    PORTB &= (uint8_t)~(1 << 1);
}

static uint16_t measure(uint8_t channel) {
    ADMUX = (1 << REFS0) | channel;
    ADCSRA = (1 << ADEN) | (1 << ADSC) | 7;
    while (ADCSRA & (1 << ADSC))
        ;
    return ADC;
}

static uint8_t __attribute__((noinline)) descend(uint8_t levels) {
    volatile uint8_t frame[10];
    frame[0] = levels;
    if (levels) frame[1] = descend((uint8_t)(levels - 1));
    return frame[0];
}

static volatile uint8_t edges;
#ifdef PCINT2_vect
ISR(PCINT2_vect) {
    ++edges;
}
#endif

// 'Q': echoes by interrupts alone, asleep in between, until it gets a 'q'.
#ifdef USART_RX_vect
static uint8_t ring[16];
static volatile uint8_t ring_in, ring_out, echoing;
ISR(USART_RX_vect) {
    uint8_t byte = UDR0;
    if (byte == 'q') echoing = 0;
    ring[ring_in++ % sizeof ring] = byte;
    UCSR0B |= 1 << UDRIE0;
}
ISR(USART_UDRE_vect) {
    UDR0 = ring[ring_out++ % sizeof ring];
    if (ring_out == ring_in) UCSR0B &= (uint8_t)~(1 << UDRIE0);
}
static void echo_by_interrupts(void) {
    ring_in = ring_out = 0;
    echoing = 1;
    UCSR0B |= 1 << RXCIE0;
    set_sleep_mode(SLEEP_MODE_IDLE);
    for (;;) {
        cli();
        if (!echoing && ring_in == ring_out) break;
        sleep_enable();
        sei();
        sleep_cpu();
        sleep_disable();
    }
    UCSR0B &= (uint8_t)~(1 << RXCIE0);
}
#endif

static void not_listening(uint8_t milliseconds) {
    while (milliseconds--)
        _delay_ms(1);
}

int main(void) {
    uint8_t boot_cause = MCUSR;
    MCUSR = 0;
    wdt_disable();
    STATUS = 1 << 1;
    BAUD_HIGH = 0;
    BAUD_LOW = 34;
    CONTROL = 0x18;
    put('!');
    put(boot_cause);
    put('\n');
    for (;;)
        switch (get()) {
            case 'W': {  // address, value: writes a register
                volatile uint8_t* address = (volatile uint8_t*)get16();
                *address = get();
                break;
            }
            case 'R':
                put(*(volatile uint8_t*)get16());
                break;
            case 'E':
                put(get());
                break;
            case 'e':  // address, value: begins to write a byte of the EEPROM
                EEAR = get16();
                EEDR = get();
                EECR = 1 << EEMPE;
                EECR |= 1 << EEPE;
                break;
            case 'F': {  // the frame error flag of the next byte, then the byte
                while (!(STATUS & (1 << BIT_RXC)))
                    ;
                uint8_t status = STATUS;
                uint8_t byte = DATA;
                put((status >> BIT_FE) & 1 ? 'f' : '-');
                put(byte);
                break;
            }
            case 'B': {  // the new UBRR value; the rate changes once the answer is out
                uint8_t divider = get();
                put('b');
                while (!(STATUS & (1 << BIT_TXC)))
                    ;
                BAUD_LOW = divider;
                break;
            }
            case 'C': {  // as 'B', in too much of a hurry
                uint8_t divider = get();
                put('c');
                BAUD_LOW = divider;
                break;
            }
            case 'T': {  // sends that many bytes as fast as the chip can
                uint8_t count = get();
                while (count--)
                    put('t');
                break;
            }
            case 'O':  // turns D13 of an Uno on and off until a byte comes
                DDRB |= 1 << 5;
                while (!(STATUS & (1 << BIT_RXC)))
                    PORTB ^= 1 << 5;
                break;
            case 'D':
                not_listening(get());
                break;
            case 'U':
                put16(echo(4));
                break;
            case 'u':
                put16(echo(5));
                break;
            case 'S':
                pulse(get16());
                break;
            case 'A':
                put16(measure(get()));
                break;
            case 'K':
                put(descend(get()));
                break;
#ifdef PCINT2_vect
            case 'I':  // counts changes of D2 (PD2 = PCINT18) from now on; 'i' reports how many
                edges = 0;
                PCMSK2 = 1 << 2;
                PCICR = 1 << 2;
                sei();
                break;
            case 'i':
                put(edges);
                break;
#endif
#ifdef USART_RX_vect
            case 'Q':
                echo_by_interrupts();
                break;
#endif
            case 'X':
                wdt_enable(WDTO_15MS);
                for (;;)
                    ;
            case 'Z':  // sleeps for good
                cli();
                set_sleep_mode(SLEEP_MODE_IDLE);
                sleep_enable();
                sleep_cpu();
                break;
        }
}
