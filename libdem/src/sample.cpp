#include "dem/sample.h"
