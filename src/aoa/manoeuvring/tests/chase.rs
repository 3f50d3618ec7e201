//! Simulated chases.

use super::*;

/// How a source and the vehicle that hunts it drive; all times in seconds.
#[derive(Clone, Copy)]
pub struct Chase {
    pub departure: f32,
    pub stop: f32,
    pub end: f32,
    pub speed: f32,
    pub heading: f32,
    /// Of the source, when and by how much.
    pub turn: (f32, f32),
    pub hunter_speed: f32,
    pub hunter_start: [f32; 2],
    /// Circles round the source, or follows it, in zigzags.
    pub circles: bool,
    pub sigma: f32,
    pub outliers: f32,
    /// Whether errors are correlated as the default configuration says.
    pub correlated: bool,
}

/// A bearing, when it was taken, in seconds, and where the source is.
pub struct Step {
    pub time: f32,
    pub source: [f32; 2],
    pub observation: Observation,
}

impl Chase {
    pub fn random(rng: &mut Xoshiro128PlusPlus) -> Self {
        let mut between = |a: f32, b: f32| a + (b - a) * uniform(rng);
        let angle = between(0.0, TAU);
        let range = between(400.0, 800.0);
        Self {
            departure: 120.0,
            stop: 240.0,
            end: 360.0,
            speed: between(8.0, 12.0),
            heading: between(0.0, TAU),
            turn: (between(150.0, 210.0), between(-2.0, 2.0)),
            hunter_speed: between(10.0, 15.0),
            hunter_start: [range * angle.cos(), range * angle.sin()],
            circles: between(0.0, 1.0) < 0.5,
            sigma: between(0.035, 0.052),
            outliers: 0.1,
            correlated: false,
        }
    }

    /// Velocity of the source at a time.
    pub fn velocity(&self, time: f32) -> [f32; 2] {
        if time < self.departure || time >= self.stop {
            return [0.0; 2];
        }
        let (when, turn) = self.turn;
        let heading = self.heading + if time < when { 0.0 } else { turn };
        [self.speed * heading.cos(), self.speed * heading.sin()]
    }

    /// Every second: the time, where the source is, and a bearing on it.
    pub fn bearings(self, seed: u64) -> Vec<Step> {
        let mut rng = generator(seed ^ 0xc4a5e);
        let (mut source, mut hunter) = ([0.0f32; 2], self.hunter_start);
        let r = if self.correlated {
            0.9 * (-self.hunter_speed / 5.0).exp()
        } else {
            0.0
        };
        let mut error = normal(&mut rng);
        let mut out = Vec::new();
        for second in 0..self.end as u32 {
            let time = second as f32;
            let [vx, vy] = self.velocity(time);
            source = [source[0] + vx, source[1] + vy];
            let (dx, dy) = (source[0] - hunter[0], source[1] - hunter[1]);
            let (range, sight) = (dx.hypot(dy), dy.atan2(dx));
            let aside = if self.circles {
                // A right angle on the circle, less outside of it.
                (FRAC_PI_2 - 0.01 * (range - 350.0)).clamp(0.3, 2.6)
            } else if range < 120.0 {
                2.0
            } else if (second / 20) % 2 == 0 {
                0.9
            } else {
                -0.9
            };
            let course = sight + aside;
            hunter[0] += self.hunter_speed * course.cos();
            hunter[1] += self.hunter_speed * course.sin();
            error = r * error + (1.0 - r * r).sqrt() * normal(&mut rng);
            let off = if uniform(&mut rng) < self.outliers {
                TAU * uniform(&mut rng)
            } else {
                self.sigma * error
            };
            out.push(Step {
                time,
                source,
                observation: towards(1000 * second, hunter, source, off, self.sigma),
            });
        }
        out
    }
}
