#include "Hardware.h"

#ifdef ARDUINO

namespace asip {
namespace hw {

uint8_t takenTimers;

}  // namespace hw
}  // namespace asip

#endif
