/* SPDX-License-Identifier: MIT */
/*
 * The three kernels.
 *
 * Bicubic is Keys, "Cubic convolution interpolation for digital image processing", 1981, eq. (8), with a = -0.75. At
 * the worst phase it loses 3-15 % of the gradients' energy where a = -0.5 loses 12-28 %, so sharpness pulses less. Its
 * weights are defined by a few operations on words: SIMD code computes them faster than it looks them up.
 *
 * Lanczos has three lobes, sinc(x) sinc(x / 3), with the weights of each phase normalized to the sum 1.
 */
#include "warp/kernel.h"

#include <math.h>

static double weigh_bilinear(double x)
{
    return fmax(0.0, 1.0 - fabs(x));
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
    double (*weigh)(double x); /* x: samples from the position to the tap. NULL: see set_cubic() */
} shapes[] = {
    [L1L2STAB_INTERPOLATION_BILINEAR] = {2, weigh_bilinear},
    [L1L2STAB_INTERPOLATION_BICUBIC] = {4, NULL},
    [L1L2STAB_INTERPOLATION_LANCZOS] = {6, weigh_lanczos3},
};

/* Weights to integers with the exact sum: the nearest tap gets what rounding leaves over. */
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

/*
 * The weights of the taps at -1, 0, 1, 2 from the sample left of a position with phase t. With n = 1 - t and q = t n,
 * eq. (8) at the distances 1 + t and t is
 *
 *   a (t^3 - 2 t^2 + t)               =  -0.75 q n
 *   (a + 2) t^3 - (a + 3) t^2 + 1     =  n - 0.25 q + 1.25 q n
 *
 * and the same with t and n exchanged from the other side. t, n and q have 15 fractional bits and weights have 14, so
 * the code below has half of each constant: 12288 / 2^15 = 0.75 / 2, 20480 / 2^15 = 1.25 / 2, 4096 / 2^15 = 0.25 / 2.
 * No weight is further than 2 / 2^14 from the exact one.
 */
static void set_cubic(int phase, int16_t *out)
{
    const int t = phase << (15 - L1L2_WARP_PHASE_BITS), n = (1 << 15) - t;
    const int q = l1l2_warp_product(t, n), qt = l1l2_warp_product(q, t), qn = l1l2_warp_product(q, n);
    const int quarter = l1l2_warp_product(q, 4096);
    out[0] = (int16_t)l1l2_warp_product(qn, -12288);
    out[1] = (int16_t)(n / 2 - quarter + l1l2_warp_product(qn, 20480));
    out[2] = (int16_t)(t / 2 - quarter + l1l2_warp_product(qt, 20480));
    out[3] = (int16_t)l1l2_warp_product(qt, -12288);
    const int nearest = n < t ? 2 : 1;
    out[nearest] = (int16_t)(out[nearest] + L1L2_WARP_ONE - out[0] - out[1] - out[2] - out[3]);
}

void l1l2_warp_kernel_init(L1L2WarpKernel *kernel, L1L2StabInterpolation interpolation)
{
    const int taps = shapes[interpolation].taps;
    const int lead = taps / 2 - 1;
    *kernel = (L1L2WarpKernel){.taps = taps, .stride = l1l2_warp_kernel_stride(taps)};
    for (int phase = 0; phase < L1L2_WARP_PHASES; phase++) {
        if (interpolation == L1L2STAB_INTERPOLATION_BICUBIC) {
            set_cubic(phase, kernel->weights + phase * kernel->stride);
            continue;
        }
        const double at = (double)phase / L1L2_WARP_PHASES;
        double weight[L1L2_WARP_MAX_TAPS];
        for (int k = 0; k < taps; k++)
            weight[k] = shapes[interpolation].weigh(k - lead - at);
        round_weights(weight, taps, lead + (at > 0.5), kernel->weights + phase * kernel->stride);
    }
}
