#include "dem/draw.h"
