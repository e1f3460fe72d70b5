/* SPDX-License-Identifier: MIT */
/* Cubic: Keys, "Cubic convolution interpolation for digital image processing", 1981, eq. (8), with a = -0.75: it loses
 * 3-15 % of the gradients' energy at the worst phase where a = -0.5 loses 12-28 %, so sharpness pulses less. */
#include "warp_kernel.h"

#include <math.h>

static double weigh_linear(double x)
{
    return fmax(0.0, 1.0 - fabs(x));
}

static double weigh_cubic(double x)
{
    const double a = -0.75;
    const double t = fabs(x);
    if (t < 1.0)
        return ((a + 2.0) * t - (a + 3.0)) * t * t + 1.0;
    if (t < 2.0)
        return ((a * t - 5.0 * a) * t + 8.0 * a) * t - 4.0 * a;
    return 0.0;
}

static double weigh_lanczos3(double x)
{
    const double t = 3.14159265358979323846 * fabs(x);
    if (t == 0.0)
        return 1.0;
    return fabs(x) < 3.0 ? 3.0 * sin(t) * sin(t / 3.0) / (t * t) : 0.0;
}

static const struct {
    int taps;
    double (*weigh)(double x); /* x: samples from the position to the tap */
} shapes[] = {
    [L1L2STAB_INTERPOLATION_BILINEAR] = {2, weigh_linear},
    [L1L2STAB_INTERPOLATION_BICUBIC] = {4, weigh_cubic},
    [L1L2STAB_INTERPOLATION_LANCZOS] = {6, weigh_lanczos3},
};

/* What rounding leaves over goes to the nearest tap. */
static void round_weights(const double *weight, int taps, int nearest, int16_t *out)
{
    double sum = 0.0;
    for (int k = 0; k < taps; k++)
        sum += weight[k];
    int left = L1L2_WARP_ONE;
    for (int k = 0; k < taps; k++) {
        out[k] = (int16_t)floor(weight[k] / sum * L1L2_WARP_ONE + 0.5);
        left -= out[k];
    }
    out[nearest] = (int16_t)(out[nearest] + left);
}

void l1l2_warp_kernel_init(L1L2WarpKernel *kernel, L1L2StabInterpolation interpolation)
{
    const int taps = shapes[interpolation].taps;
    const int lead = taps / 2 - 1;
    *kernel = (L1L2WarpKernel){.taps = taps, .stride = l1l2_warp_kernel_stride(taps)};
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        const double at = (double)phase / L1L2_WARP_PHASES;
        double weight[L1L2_WARP_MAX_TAPS];
        for (int k = 0; k < taps; k++)
            weight[k] = shapes[interpolation].weigh(k - lead - at);
        round_weights(weight, taps, lead + (at > 0.5), kernel->weights + phase * kernel->stride);
    }
}
