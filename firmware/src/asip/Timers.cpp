#include "Hardware.h"

#ifdef __AVR__

namespace asip {
namespace hw {

uint8_t takenTimers;

}  // namespace hw
}  // namespace asip

#endif
