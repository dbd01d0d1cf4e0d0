#include "dem/image.h"
